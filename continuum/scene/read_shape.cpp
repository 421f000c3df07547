#include "continuum/scene/read_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "continuum/scene/read_common.h"

namespace talus {
namespace {

using Geometry = decltype(Shape::geometry);

constexpr std::size_t most_corners = 1000;  // of a profile

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

Eigen::Vector3d direction(const CheckedTable& table, std::string_view key) {
  const Eigen::Vector3d given = table.vector(key);
  const double length = given.stableNorm();
  if (!std::isnormal(length)) throw table.error(key, "must be a direction, such as [0, 0, 1]");
  return given / length;
}

Geometry read_plane(const CheckedTable& table) {
  return Plane{table.vector("point_m", coordinate_range), direction(table, "normal")};
}

Geometry read_box(const CheckedTable& table) {
  const Eigen::Vector3d lower = table.vector("lower_m", coordinate_range),
                        upper = table.vector("upper_m", coordinate_range);
  if ((lower.array() >= upper.array()).any())
    throw table.error("upper_m", "must lie above lower_m along every axis");
  Box box{0.5 * (lower + upper), 0.5 * (upper - lower)};
  const bool has_axis = table.has("rotation_axis"), has_angle = table.has("rotation_angle_deg");
  if (has_axis || has_angle) {
    const Eigen::Vector3d axis = direction(table, "rotation_axis");
    const double angle = radians(table.number("rotation_angle_deg", {-360.0, 360.0}));
    box.rotation = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  }
  return box;
}

Geometry read_sphere(const CheckedTable& table) {
  return Sphere{table.vector("centre_m", coordinate_range), table.number("radius_m", length_range)};
}

Geometry read_capsule(const CheckedTable& table) {
  const Eigen::Vector3d from = table.vector("from_m", coordinate_range),
                        to = table.vector("to_m", coordinate_range);
  if (from == to) throw table.error("to_m", "must differ from from_m; of length 0 it is a sphere");
  return Capsule{from, to, table.number("radius_m", length_range)};
}

Geometry read_cylinder(const CheckedTable& table) {
  return cylinder(table.vector("base_m", coordinate_range), direction(table, "axis"),
                  table.number("radius_m", length_range), table.number("height_m", length_range));
}

Geometry read_cone(const CheckedTable& table) {
  const double base_radius = table.number("base_radius_m", non_negative_length);
  const double top_radius =
      table.number("top_radius_m", base_radius > 0.0 ? non_negative_length : length_range);
  return cone(table.vector("base_m", coordinate_range), direction(table, "axis"), base_radius, top_radius,
              table.number("height_m", length_range));
}

Geometry read_hourglass(const CheckedTable& table) {
  HourglassSize size{};
  size.bulb_radius = table.number("bulb_radius_m", length_range);
  size.bulb_height = table.number("bulb_height_m", non_negative_length);
  size.neck_radius = table.number("neck_radius_m", length_range);
  if (size.neck_radius >= size.bulb_radius)
    throw table.error("neck_radius_m", "must be less than bulb_radius_m");
  size.neck_length = table.number("neck_length_m", non_negative_length);
  size.cone_half_angle = radians(table.number("cone_half_angle_deg", {1.0, 89.0}));
  return hourglass(table.vector("base_m", coordinate_range), direction(table, "axis"), size);
}

Geometry read_profile(const CheckedTable& table) {
  auto points = table.pairs("points_m", non_negative_length, coordinate_range);
  if (points.size() > most_corners)  // each edge is held against every other
    throw table.error("points_m", fmt::format("must be at most {} corners", most_corners));
  if (const auto fault = profile_fault(points)) throw table.error("points_m", *fault);
  return Revolved{table.vector("base_m", coordinate_range), direction(table, "axis"), std::move(points)};
}

Geometry read_mesh_file(const CheckedTable& table) {
  const auto file = table.file().parent_path() / table.string("file");
  const double scale = table.number("scale", {1e-9, 1e9}, 1.0);
  const Eigen::Vector3d offset = table.has("offset_m") ? table.vector("offset_m", coordinate_range)
                                                       : Eigen::Vector3d(Eigen::Vector3d::Zero());
  try {
    return read_mesh(file, scale, offset);
  } catch (const InputError& error) {
    throw table.error("file", error.what());
  }
}

constexpr std::array<std::string_view, 9> kinds{"plane", "box",       "sphere",  "capsule", "cylinder",
                                                "cone",  "hourglass", "profile", "mesh"};
constexpr std::array<Geometry (*)(const CheckedTable&), kinds.size()> readers{
    read_plane, read_box,       read_sphere,  read_capsule,  read_cylinder,
    read_cone,  read_hourglass, read_profile, read_mesh_file};

}  // namespace

Shape read_shape(const CheckedTable& table) {
  const std::string kind = table.choice("kind", kinds);
  const auto which = std::find(kinds.begin(), kinds.end(), kind) - kinds.begin();
  Shape shape{readers[static_cast<std::size_t>(which)](table)};
  if (kind != "plane") shape.hollow = table.boolean("hollow", false);
  table.finish();
  return shape;
}

}  // namespace talus
