#include "validation/parameters.h"

#include <numbers>
#include <variant>

#include "validation/gates/profile_distance.h"

namespace talus::validation {
namespace {

using nlohmann::json;

struct GeometryJson {
  json operator()(const dem::ColumnGeometry& g) const {
    return {{"column_length_m", g.column_length},
            {"column_height_m", g.column_height},
            {"thickness_m", g.thickness},
            {"tank_length_m", g.tank_length},
            {"floor", g.rough_floor ? "rough" : "flat"}};
  }
  json operator()(const dem::CylinderGeometry& g) const {
    return {{"radius_m", g.radius}, {"height_m", g.height}, {"floor_side_m", g.floor_side}};
  }
  json operator()(const dem::HeapGeometry& g) const {
    return {{"radius_m", g.radius},
            {"height_m", g.height},
            {"floor_side_m", g.floor_side},
            {"lift_speed_m_s", g.lift_speed}};
  }
  json operator()(const dem::SlotGeometry& g) const {
    return {{"width_m", g.width},
            {"height_m", g.height},
            {"thickness_m", g.thickness},
            {"opening_m", g.opening},
            {"drop_m", g.drop}};
  }
  json operator()(const dem::HourglassGeometry& g) const {
    return {{"throat_radius_m", g.throat_radius},
            {"bulb_radius_m", g.bulb_radius},
            {"cone_height_m", g.cone_height},
            {"height_m", g.height},
            {"bulb_height_m", g.bulb_height}};
  }
  json operator()(const dem::ImpactGeometry& g) const {
    return {{"side_m", g.side},
            {"height_m", g.height},
            {"sphere_diameter_m", g.sphere_diameter},
            {"sphere_density_kg_m3", g.sphere_density},
            {"impact_speed_m_s", g.impact_speed}};
  }
  json operator()(const dem::LedgeGeometry& g) const {
    return {{"length_m", g.length},
            {"height_m", g.height},
            {"thickness_m", g.thickness},
            {"drop_m", g.drop},
            {"tank_length_m", g.tank_length}};
  }
};

json ruler_json(const dem::Case& a_case) {
  const dem::Ruler& r = a_case.ruler;
  json ruler{{"profile_bin_m", r.profile_bin}};
  if (r.front_depth > 0.0) ruler["front_depth_m"] = r.front_depth;
  if (r.window_upper > 0.0) {
    ruler["window_upper"] = r.window_upper;
    ruler["window_lower"] = r.window_lower;
  }
  return ruler;
}

}  // namespace

std::string family_of(const dem::Case& a_case) {
  if (a_case.kind.ends_with("collapse")) return "column collapse";
  if (a_case.kind == "slot" || a_case.kind == "hourglass") return "hourglass";
  if (a_case.kind == "impact") return "impact";
  return "pile angle";
}

std::string unit_of(const dem::Case& a_case, const std::string& observable) {
  if (observable == "discharge_rate") return "kg/s";
  if (observable == "repose_angle") return "deg";
  if (observable == "stop_time") return "s";
  if (observable == "penetration_depth") return "m";
  if (is_distance(observable) || observable == "beverloo_C") return "1";
  return a_case.kind == "cylinder_collapse" ? "R0" : "L0";
}

json length_unit_of(const dem::Case& a_case) {
  if (a_case.kind == "column_collapse") return {{"symbol", "L0"}, {"metres", cell_length(a_case)}};
  if (a_case.kind == "cylinder_collapse") return {{"symbol", "R0"}, {"metres", cell_length(a_case)}};
  return nullptr;
}

json parameters_of(const SuitePoint& point) {
  const dem::Case& c = point.a_case;
  return {
      {"geometry", std::visit(GeometryJson{}, c.geometry)},
      {"grains",
       {{"diameter_m", c.grains.diameter},
        {"diameter_spread", c.grains.diameter_spread},
        {"density_kg_m3", c.grains.density},
        {"youngs_modulus_pa", c.grains.youngs_modulus},
        {"poissons_ratio", c.grains.poissons_ratio}}},
      {"contact",
       {{"restitution", c.contact.restitution},
        {"friction", c.contact.friction},
        {"rolling_friction", c.contact.rolling_friction},
        {"wall_friction", c.contact.wall_friction}}},
      {"protocol",
       {{"gravity_m_s2", c.protocol.gravity},
        {"volume_fraction", c.protocol.volume_fraction},
        {"settle_time_s", c.protocol.settle_time},
        {"run_time_s", c.protocol.run_time},
        {"snapshot_interval_s", c.protocol.snapshot_interval},
        {"time_step_s", c.protocol.time_step},
        {"rest_energy", c.protocol.rest_energy}}},
      {"ruler", ruler_json(c)},
      {"continuum",
       {{"cells", point.resolution.cells},
        {"cell_size_m", cell_size(c, point.resolution.cells)},
        {"particles_per_cell_axis", point.resolution.particles_per_cell_axis},
        {"lattice_jitter", point.resolution.lattice_jitter}}},
  };
}

json calibration_of(const Suite& suite, const SuitePoint& point) {
  const dem::MaterialConstants& material = point.material;
  json calibration{{"name", point.a_case.calibration},
                   {"file", suite.calibration.filename().string()},
                   {"input_hash", suite.calibration_hash},
                   {"friction_angle_deg", material.friction_angle * 180.0 / std::numbers::pi},
                   {"max_volume_fraction", material.max_volume_fraction},
                   {"status", material.status},
                   {"source", material.source}};
  if (material.friction_law) {
    calibration["mu_1"] = material.friction_law->mu_1;
    calibration["mu_2"] = material.friction_law->mu_2;
    calibration["I_0"] = material.friction_law->I_0;
  }
  return calibration;
}

}  // namespace talus::validation
