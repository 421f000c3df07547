#include "dem_cases/container.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "dem_cases/falling_sphere.h"

namespace talus::dem {
namespace {

/// How high a tube must be for the loose packing, which stands about twice as high as the settled one.
double tube_height(double fill_height, double diameter) { return 2.5 * fill_height + 6.0 * diameter; }

struct Build {
  double d;  // grain diameter, m

  Container operator()(const ColumnGeometry& g) const {
    Container c{
        .periodic = true,
        .lower = {-d, 0.0, -2.0 * d},
        .upper = {g.tank_length + d, g.thickness, 0.0},
        .lowest = g.rough_floor ? -floor_centre_depth * d : 0.0,
        .planes =
            {{.name = "back_wall", .axis = 0, .at = 0.0, .inward = 1},
             {.name = "far_wall", .axis = 0, .at = g.tank_length, .inward = -1, .must_stay_clear = true},
             {.name = "gate", .axis = 0, .at = g.column_length, .inward = -1, .until_release = true}},
        .shells = {}};
    if (!g.rough_floor)
      c.planes.push_back(
          {.name = "flat_floor", .axis = 2, .at = 0.0, .inward = 1, .surface = Surface::floor});
    return c;
  }

  Container operator()(const CylinderGeometry& g) const {
    Container c = on_square_floor(g.floor_side);
    c.shells = {tube(g.radius, g.height)};
    c.shells.front().until_release = true;
    return c;
  }

  Container operator()(const HeapGeometry& g) const {
    Container c = on_square_floor(g.floor_side);
    c.shells = {tube(g.radius, g.height)};
    c.shells.front().rise_speed = g.lift_speed;
    return c;
  }

  Container operator()(const SlotGeometry& g) const {
    return {
        .periodic = true,
        .lower = {-d, 0.0, -g.drop - d},
        .upper = {g.width + d, g.thickness, 0.0},
        .lowest = -g.drop,
        .planes = {{.name = "left_wall", .axis = 0, .at = 0.0, .inward = 1},
                   {.name = "right_wall", .axis = 0, .at = g.width, .inward = -1},
                   {.name = "catch_floor", .axis = 2, .at = -g.drop, .inward = 1, .surface = Surface::floor},
                   {.name = "gate", .axis = 2, .at = 0.0, .inward = 1, .until_release = true}},
        .shells = {}};
  }

  Container operator()(const LedgeGeometry& g) const {
    return {
        .periodic = true,
        .lower = {-d, 0.0, -g.drop - d},
        .upper = {g.tank_length + d, g.thickness, 0.0},
        .lowest = -g.drop,
        .planes = {{.name = "back_wall", .axis = 0, .at = 0.0, .inward = 1},
                   {.name = "far_wall", .axis = 0, .at = g.tank_length, .inward = -1},
                   {.name = "catch_floor", .axis = 2, .at = -g.drop, .inward = 1, .surface = Surface::floor},
                   {.name = "gate", .axis = 0, .at = g.length, .inward = -1, .until_release = true}},
        .shells = {}};
  }

  Container operator()(const ImpactGeometry& g) const {
    Container c = on_square_floor(g.side);  // its edges are walls that the bed leans on
    for (Plane& plane : c.planes) plane.must_stay_clear = false;
    return c;
  }

  Container operator()(const HourglassGeometry& g) const {
    const double side = g.bulb_radius + d, top = tube_height(g.height, d);
    return {
        .periodic = false,
        .lower = {-side, -side, -g.bulb_height - d},
        .upper = {side, side, top + d},
        .lowest = -g.bulb_height,
        .planes =
            {{.name = "bulb_floor", .axis = 2, .at = -g.bulb_height, .inward = 1, .surface = Surface::floor},
             {.name = "gate", .axis = 2, .at = 0.0, .inward = 1, .until_release = true}},
        .shells = {{.name = "glass",
                    .profile = {{g.bulb_radius, -g.bulb_height},
                                {g.bulb_radius, -g.cone_height},
                                {g.throat_radius, 0.0},
                                {g.bulb_radius, g.cone_height},
                                {g.bulb_radius, top}}}}};
  }

 private:
  Shell tube(double radius, double height) const {
    return {.name = "tube", .profile = {{radius, 0.0}, {radius, tube_height(height, d)}}};
  }

  Container on_square_floor(double side) const {
    const double half = 0.5 * side;
    const auto edge = [&](const char* name, int axis, int inward) {
      return Plane{
          .name = name, .axis = axis, .at = -inward * half, .inward = inward, .must_stay_clear = true};
    };
    return {.periodic = false,
            .lower = {-half - d, -half - d, -2.0 * d},
            .upper = {half + d, half + d, 0.0},
            .lowest = -floor_centre_depth * d,
            .planes = {edge("west_edge", 0, 1), edge("east_edge", 0, -1), edge("south_edge", 1, 1),
                       edge("north_edge", 1, -1)},
            .shells = {}};
  }
};

/// Radius of the shell at height z; infinite above and below it.
double radius_at(const Shell& shell, double z) {
  for (std::size_t i = 1; i < shell.profile.size(); ++i) {
    const auto &below = shell.profile[i - 1], &above = shell.profile[i];
    if (z >= below.y() && z <= above.y())
      return below.x() + (above.x() - below.x()) * (z - below.y()) / (above.y() - below.y());
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

Container container_of(const Case& a_case) {
  Container container = std::visit(Build{a_case.grains.diameter}, a_case.geometry);
  for (const Shell& shell : container.shells) {  // wherever they rise to, they stay inside
    const double top = shell.profile.back().y() + shell.rise_speed * a_case.protocol.run_time;
    container.upper.z() = std::max(container.upper.z(), top + a_case.grains.diameter);
  }
  if (const auto sphere = falling_sphere(a_case))
    container.upper.z() = std::max(container.upper.z(), sphere->room);
  return container;
}

std::vector<Triangle> triangles_of(const Shell& shell) {
  const auto corner = [](const Eigen::Vector2d& point, int segment) {
    const double angle = 2.0 * std::numbers::pi * (segment % shell_segments) / shell_segments;
    return Eigen::Vector3d(point.x() * std::cos(angle), point.x() * std::sin(angle), point.y());
  };
  std::vector<Triangle> triangles;
  for (std::size_t i = 1; i < shell.profile.size(); ++i) {
    for (int k = 0; k < shell_segments; ++k) {
      const auto a = corner(shell.profile[i - 1], k), b = corner(shell.profile[i - 1], k + 1);
      const auto c = corner(shell.profile[i], k), e = corner(shell.profile[i], k + 1);
      triangles.push_back({a, b, e});
      triangles.push_back({a, e, c});
    }
  }
  return triangles;
}

std::string leak(const Container& container, const Eigen::Vector3d& centre, bool released) {
  if (centre.z() < container.lowest) return "floor";
  for (const Plane& plane : container.planes) {
    if (plane.until_release && released) continue;
    if ((centre[plane.axis] - plane.at) * plane.inward < 0.0) return plane.name;
  }
  for (const Shell& shell : container.shells) {
    if (released && (shell.until_release || shell.rise_speed != 0.0)) continue;
    if (centre.head<2>().norm() > radius_at(shell, centre.z())) return shell.name;
  }
  return {};
}

}  // namespace talus::dem
