#include "continuum/render/bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"
#include "continuum/solids/body_images.h"
#include "continuum/solids/mesh_file.h"

namespace talus {
namespace {

constexpr std::string_view header = "time_s,body,x_m,y_m,z_m,qw,qx,qy,qz";  // more may follow
constexpr std::size_t columns_read = 9;
constexpr double unit_tolerance = 1e-4;  // of a quaternion's length: rows may be rounded
constexpr double time_tolerance = 1e-9;  // s

struct Row {
  std::string body;
  DrawnBody::Moment moment;
};

/// `place`: FILE:LINE, for errors.
Row read_row(const std::string& place, const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  if (cells.size() < columns_read) throw InputError(fmt::format("{}: must hold {}", place, header));
  const auto number = [&](std::size_t column) {
    const std::string& text = cells[column];
    double value = 0.0;
    const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (failure != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
      throw InputError(fmt::format("{}: '{}' is not a number", place, text));
    return value;
  };
  const Eigen::Quaterniond turned(number(5), number(6), number(7), number(8));
  if (std::abs(turned.norm() - 1.0) > unit_tolerance)
    throw InputError(fmt::format("{}: the quaternion's length is {}, not 1", place, turned.norm()));
  Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
  placement.linear() = turned.normalized().toRotationMatrix();
  placement.translation() = Eigen::Vector3d(number(2), number(3), number(4));
  return {cells[1], {number(0), placement}};
}

}  // namespace

Triangles read_triangles(const std::filesystem::path& file) {
  TriangleSoup read = read_triangles_of_file(file);
  Triangles triangles{std::move(read.points), {}};
  for (const auto& t : read.triangles)
    triangles.faces.push_back(
        {static_cast<unsigned>(t[0]), static_cast<unsigned>(t[1]), static_cast<unsigned>(t[2])});
  if (triangles.faces.empty()) throw InputError(fmt::format("{}: holds no triangle", file.string()));
  return triangles;
}

std::vector<DrawnBody> read_bodies(const std::filesystem::path& run_folder) {
  const auto file = run_folder / "bodies.csv";
  if (!std::filesystem::exists(file)) return {};
  std::istringstream lines(read_file(file));
  std::string line;
  std::getline(lines, line);
  if (!line.starts_with(header)) throw InputError(fmt::format("{}:1: must be {}", file.string(), header));
  std::map<std::string, std::vector<DrawnBody::Moment>> moments;
  for (int number = 2; std::getline(lines, line); ++number) {
    const std::string place = fmt::format("{}:{}", file.string(), number);
    const Row row = read_row(place, line);
    auto& of_body = moments[row.body];
    if (!of_body.empty() && row.moment.time < of_body.back().time)
      throw InputError(fmt::format("{}: goes back in time", place));
    of_body.push_back(row.moment);
  }
  std::vector<DrawnBody> bodies;
  for (auto& [name, of_body] : moments)
    bodies.push_back({name, read_triangles(run_folder / "bodies" / (name + ".stl")), std::move(of_body)});
  return bodies;
}

const Eigen::Isometry3d& placement_at(const DrawnBody& body, double time) {
  const auto after =
      std::upper_bound(body.moments.begin(), body.moments.end(), time + time_tolerance,
                       [](double t, const DrawnBody::Moment& moment) { return t < moment.time; });
  if (after == body.moments.begin())
    throw InputError(fmt::format("bodies.csv: says nothing of body '{}' by {} s", body.name, time));
  return std::prev(after)->placement;
}

std::vector<Eigen::Isometry3d> images_at(const DrawnBody& body, double time, const Grid& grid) {
  const Eigen::Isometry3d& placement = placement_at(body, time);
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& corner : body.surface.corners) box.extend(placement * corner.cast<double>());
  std::vector<Eigen::Isometry3d> images;
  for (const Eigen::Vector3d& shift : shifts_into_domain(grid, box))
    images.emplace_back(Eigen::Translation3d(shift) * placement);
  return images;
}

}  // namespace talus
