#include "dem_cases/geometry.h"

#include <algorithm>
#include <numbers>

namespace talus::dem {
namespace {

constexpr double pi = std::numbers::pi;

struct Volume {
  double operator()(const ColumnGeometry& g) const { return g.column_length * g.thickness * g.column_height; }
  double operator()(const CylinderGeometry& g) const { return pi * g.radius * g.radius * g.height; }
  double operator()(const HeapGeometry& g) const { return pi * g.radius * g.radius * g.height; }
  double operator()(const SlotGeometry& g) const { return g.width * g.thickness * g.height; }
  double operator()(const LedgeGeometry& g) const { return g.length * g.thickness * g.height; }
  double operator()(const ImpactGeometry& g) const { return g.side * g.side * g.height; }
  double operator()(const HourglassGeometry& g) const {
    const double in_cone = std::min(g.height, g.cone_height);
    const double top =
        g.throat_radius + (g.bulb_radius - g.throat_radius) * in_cone / g.cone_height;  // radius there
    const double cone =
        pi / 3.0 * in_cone * (g.throat_radius * g.throat_radius + g.throat_radius * top + top * top);
    return cone + pi * g.bulb_radius * g.bulb_radius * (g.height - in_cone);
  }
};

}  // namespace

double fill_height(const Geometry& geometry) {
  return std::visit(
      [](const auto& g) {
        if constexpr (requires { g.height; })
          return g.height;
        else
          return g.column_height;
      },
      geometry);
}

double fill_volume(const Geometry& geometry) { return std::visit(Volume{}, geometry); }

double floor_area(const Geometry& geometry) {
  return std::visit(
      [](const auto& g) {
        if constexpr (requires { g.floor_side; })
          return g.floor_side * g.floor_side;
        else if constexpr (requires { g.side; })
          return g.side * g.side;
        else if constexpr (requires { g.rough_floor; })
          return g.rough_floor ? g.tank_length * g.thickness : 0.0;
        else if constexpr (requires { g.opening; })
          return (g.width - g.opening) * g.thickness;
        else if constexpr (requires { g.drop; })
          return g.length * g.thickness;
        else
          return 0.0;
      },
      geometry);
}

double periodic_thickness(const Geometry& geometry) {
  return std::visit(
      [](const auto& g) {
        if constexpr (requires { g.thickness; })
          return g.thickness;
        else
          return 0.0;
      },
      geometry);
}

}  // namespace talus::dem
