#include "dem_cases/read_geometry.h"

#include <fmt/format.h>

#include <array>

namespace talus::dem {
namespace {

constexpr std::array<std::string_view, 2> floors{"rough", "flat"};
constexpr double longest = 100.0;  // m

/// A length of at least `least_diameters` grain diameters.
double length(const CheckedTable& table, std::string_view key, const Grains& grains, double least_diameters) {
  const double value = table.number(key, {smallest_positive, longest});
  const double least = least_diameters * grains.diameter;
  if (value < least * (1.0 - 1e-9)) {
    throw table.error(key,
                      fmt::format("must be at least {} grain diameters, {:.6g}", least_diameters, least));
  }
  return value;
}

/// Thinner, a grain would touch its own periodic image's neighbours twice.
double thickness(const CheckedTable& table, const Grains& grains) {
  return length(table, "thickness_m", grains, 3.0);
}

/// `whole` must leave room for the grains beside `part`.
void require_room(const CheckedTable& table, std::string_view key, double whole, double part,
                  std::string_view part_text, const Grains& grains) {
  if (whole < part + 2.0 * grains.diameter) {
    throw table.error(key, fmt::format("must leave room {}: more than {:.6g} with 2 grain diameters",
                                       part_text, part + 2.0 * grains.diameter));
  }
}

Geometry read_column(const CheckedTable& table, const Grains& grains) {
  const ColumnGeometry g{.column_length = length(table, "column_length_m", grains, 4.0),
                         .column_height = length(table, "column_height_m", grains, 2.0),
                         .thickness = thickness(table, grains),
                         .tank_length = table.number("tank_length_m", {smallest_positive, longest}),
                         .rough_floor = table.choice("floor", floors) == "rough"};
  require_room(table, "tank_length_m", g.tank_length, g.column_length, "in front of the gate", grains);
  return g;
}

Geometry read_cylinder(const CheckedTable& table, const Grains& grains) {
  const CylinderGeometry g{.radius = length(table, "radius_m", grains, 4.0),
                           .height = length(table, "height_m", grains, 2.0),
                           .floor_side = table.number("floor_side_m", {smallest_positive, longest})};
  require_room(table, "floor_side_m", g.floor_side, 2.0 * g.radius, "about the cylinder", grains);
  return g;
}

Geometry read_heap(const CheckedTable& table, const Grains& grains) {
  const HeapGeometry g{.radius = length(table, "radius_m", grains, 4.0),
                       .height = length(table, "height_m", grains, 2.0),
                       .floor_side = table.number("floor_side_m", {smallest_positive, longest}),
                       .lift_speed = table.number("lift_speed_m_s", {1e-4, 10.0})};
  require_room(table, "floor_side_m", g.floor_side, 2.0 * g.radius, "about the tube", grains);
  return g;
}

Geometry read_slot(const CheckedTable& table, const Grains& grains) {
  const SlotGeometry g{.width = length(table, "width_m", grains, 8.0),
                       .height = length(table, "height_m", grains, 2.0),
                       .thickness = thickness(table, grains),
                       .opening = length(table, "opening_m", grains, 3.0),
                       .drop = length(table, "drop_m", grains, 4.0)};
  require_room(table, "width_m", g.width, g.opening, "for a bottom beside the slot", grains);
  return g;
}

Geometry read_hourglass(const CheckedTable& table, const Grains& grains) {
  const HourglassGeometry g{.throat_radius = length(table, "throat_radius_m", grains, 1.5),
                            .bulb_radius = length(table, "bulb_radius_m", grains, 3.0),
                            .cone_height = length(table, "cone_height_m", grains, 1.0),
                            .height = length(table, "height_m", grains, 2.0),
                            .bulb_height = table.number("bulb_height_m", {smallest_positive, longest})};
  if (g.bulb_radius <= g.throat_radius)
    throw table.error("bulb_radius_m",
                      fmt::format("must be more than throat_radius_m = {}", g.throat_radius));
  if (g.bulb_height < g.cone_height)
    throw table.error("bulb_height_m", fmt::format("must be at least cone_height_m = {}", g.cone_height));
  require_room(table, "bulb_height_m", g.bulb_height, g.height, "over the fill", grains);
  return g;
}

Geometry read_ledge(const CheckedTable& table, const Grains& grains) {
  const LedgeGeometry g{.length = length(table, "length_m", grains, 8.0),
                        .height = length(table, "height_m", grains, 2.0),
                        .thickness = thickness(table, grains),
                        .drop = length(table, "drop_m", grains, 4.0),
                        .tank_length = table.number("tank_length_m", {smallest_positive, longest})};
  require_room(table, "tank_length_m", g.tank_length, g.length, "beside the ledge", grains);
  return g;
}

Geometry read_impact(const CheckedTable& table, const Grains& grains) {
  const ImpactGeometry g{.side = length(table, "side_m", grains, 8.0),
                         .height = length(table, "height_m", grains, 4.0),
                         .sphere_diameter = length(table, "sphere_diameter_m", grains, 2.0),
                         .sphere_density = table.number("sphere_density_kg_m3", {100.0, 30000.0}),
                         .impact_speed = table.number("impact_speed_m_s", {0.01, 100.0})};
  require_room(table, "side_m", g.side, g.sphere_diameter, "about the sphere", grains);
  return g;
}

}  // namespace

Geometry read_geometry(const CheckedTable& table, std::string_view kind, const Grains& grains) {
  const auto read = kind == "column_collapse"     ? read_column
                    : kind == "cylinder_collapse" ? read_cylinder
                    : kind == "heap"              ? read_heap
                    : kind == "slot"              ? read_slot
                    : kind == "hourglass"         ? read_hourglass
                    : kind == "impact"            ? read_impact
                                                  : read_ledge;
  Geometry geometry = read(table, grains);
  table.finish();
  return geometry;
}

}  // namespace talus::dem
