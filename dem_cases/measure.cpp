#include "dem_cases/measure.h"

#include <cmath>
#include <numbers>

#include "analysis/observables/column_collapse.h"
#include "analysis/observables/cylinder_collapse.h"
#include "analysis/observables/discharge.h"
#include "analysis/observables/impact.h"
#include "analysis/observables/repose_angle.h"

namespace talus::dem {
namespace {

using analysis::SnapshotSeries;
using nlohmann::json;

constexpr double degrees = 180.0 / std::numbers::pi;

/// What the series did not give is null.
json or_null(json observables) {
  for (auto& value : observables) {
    if (value.is_number_float() && !std::isfinite(value.get<double>())) value = nullptr;
  }
  return observables;
}

json profile_json(const analysis::DepthProfile& profile) {
  return {{"x", profile.x}, {"depth", profile.depth}};
}

json measure_column(const Case& a_case, const SnapshotSeries& series, double thickness) {
  const auto m = analysis::measure_column_collapse(
      series,
      {column_geometry(a_case).column_length, thickness, a_case.ruler.profile_bin, a_case.ruler.front_depth});
  const auto& o = m.observables;
  return {{"observables", or_null({{"runout", o.runout},
                                   {"x90", o.x90},
                                   {"x95", o.x95},
                                   {"centre_of_mass", o.centre_of_mass},
                                   {"final_height", o.final_height},
                                   {"stop_time", o.stop_time},
                                   {"settled_height", o.settled_height},
                                   {"settled_volume_fraction", o.settled_volume_fraction},
                                   {"lost_volume", o.lost_volume},
                                   {"at_rest", o.at_rest}})},
          {"curves",
           {{"time", m.curves.time},
            {"front", m.curves.front},
            {"x95", m.curves.x95},
            {"centre_of_mass", m.curves.centre_of_mass},
            {"height", m.curves.height}}},
          {"final_profile", profile_json(m.final_profile)}};
}

json measure_cylinder(const Case& a_case, const CylinderGeometry& geometry, const SnapshotSeries& series) {
  const auto m = analysis::measure_cylinder_collapse(
      series, {{0.0, 0.0}, geometry.radius, a_case.ruler.profile_bin, a_case.ruler.front_depth});
  const auto& o = m.observables;
  return {{"observables", or_null({{"runout", o.runout},
                                   {"r90", o.r90},
                                   {"r95", o.r95},
                                   {"mean_radius", o.mean_radius},
                                   {"final_height", o.final_height},
                                   {"stop_time", o.stop_time},
                                   {"roundness", o.roundness},
                                   {"settled_height", o.settled_height},
                                   {"settled_volume_fraction", o.settled_volume_fraction},
                                   {"lost_volume", o.lost_volume},
                                   {"at_rest", o.at_rest}})},
          {"curves",
           {{"time", m.curves.time},
            {"front", m.curves.front},
            {"r95", m.curves.r95},
            {"mean_radius", m.curves.mean_radius},
            {"height", m.curves.height}}},
          {"final_profile", profile_json(m.final_profile)}};
}

json measure_sphere(const Case& a_case, const ImpactGeometry& geometry, const SnapshotSeries& series,
                    const analysis::BodyTrack& track) {
  const auto m = analysis::measure_impact(
      series, track, {0.5 * geometry.sphere_diameter, geometry.side, a_case.ruler.profile_bin});
  const auto& o = m.observables;
  return {{"observables", or_null({{"penetration_depth", o.penetration_depth},
                                   {"stop_time", o.stop_time},
                                   {"contact_speed", o.contact_speed},
                                   {"settled_height", o.settled_height},
                                   {"settled_volume_fraction", o.settled_volume_fraction},
                                   {"lost_volume", o.lost_volume},
                                   {"at_rest", o.at_rest}})},
          {"curves", {{"time", m.curves.time}, {"depth", m.curves.depth}, {"speed", m.curves.speed}}},
          {"final_profile", profile_json(m.final_profile)}};
}

/// In quasi-2-D a code may run another thickness than the case's; figures are those of the case's.
json measure_outflow(const Case& a_case, const SnapshotSeries& series, double thickness) {
  const double case_thickness = periodic_thickness(a_case.geometry);
  const double scale = case_thickness > 0.0 ? case_thickness / thickness : 1.0;
  const auto m = analysis::measure_discharge(series, {.opening = Eigen::Vector3d::Zero(),
                                                      .grain_density = a_case.grains.density,
                                                      .most_fill = a_case.ruler.window_upper,
                                                      .least_fill = a_case.ruler.window_lower});
  const auto& o = m.observables;
  std::vector<double> mass = m.curve.mass;
  for (double& kilograms : mass) kilograms *= scale;
  json observables{
      {"discharge_rate", scale * o.rate}, {"discharge_rate_error", scale * o.rate_standard_error},
      {"flatness", o.flatness},           {"window_start", o.window_start},
      {"window_end", o.window_end},       {"residual", o.residual},
      {"released_mass", mass.front()}};
  if (o.emptied_time) observables["emptied_time"] = *o.emptied_time;
  return {{"observables", observables}, {"curves", {{"time", m.curve.time}, {"mass", mass}}}};
}

/// Share of the volume above the floor that left it over the last tenth of the time.
double still_leaving(const SnapshotSeries& series) {
  const auto above = [](const analysis::Snapshot& snapshot) {
    return (snapshot.positions.row(2).transpose().array() > 0.0).select(snapshot.volumes, 0.0).sum();
  };
  const auto before = static_cast<std::size_t>(0.9 * static_cast<double>(series.size() - 1));
  return 1.0 - above(series.back()) / above(series[before]);
}

/// Kinetic energy of what lies above the floor, over m g d.
double energy_of_pile(const Case& a_case, const analysis::Snapshot& snapshot) {
  const auto above = (snapshot.positions.row(2).transpose().array() > 0.0).eval();
  const Eigen::ArrayXd squared = snapshot.velocities.colwise().squaredNorm().transpose();
  const Eigen::ArrayXd volumes = above.select(snapshot.volumes, 0.0);
  return 0.5 * (squared * volumes).sum() / (volumes.sum() * a_case.protocol.gravity * a_case.grains.diameter);
}

constexpr double most_leaving = 0.002, most_energy = 1e-3;

json measure_pile(const Case& a_case, const SnapshotSeries& series, const analysis::ReposeRuler& ruler) {
  const double leaving = still_leaving(series), energy = energy_of_pile(a_case, series.back());
  const auto m = analysis::measure_repose_angle(series.back(), ruler);
  return {{"observables", or_null({{"repose_angle", m.angle * degrees},
                                   {"repose_angle_fit_error", m.fit_standard_error * degrees},
                                   {"repose_angle_sector_deviation", m.sector_deviation * degrees},
                                   {"crest_height", m.crest_height},
                                   {"volume_fraction", m.volume_fraction},
                                   {"still_leaving", leaving},
                                   {"rest_energy", energy},
                                   {"at_rest", leaving <= most_leaving && energy <= most_energy}})},
          {"curves", json::object()},
          {"final_profile", profile_json(m.surface)}};
}

}  // namespace

json measure(const Case& a_case, const SnapshotSeries& series, double thickness,
             const analysis::BodyTrack& track) {
  const Geometry& geometry = a_case.geometry;
  if (std::holds_alternative<ColumnGeometry>(geometry)) return measure_column(a_case, series, thickness);
  if (const auto* g = std::get_if<CylinderGeometry>(&geometry)) return measure_cylinder(a_case, *g, series);
  if (const auto* g = std::get_if<ImpactGeometry>(&geometry))
    return measure_sphere(a_case, *g, series, track);
  if (const auto* g = std::get_if<LedgeGeometry>(&geometry)) {
    return measure_pile(a_case, series,
                        {.shape = analysis::PlanarSlope{0.0, 1.0, 0.0, thickness},
                         .bin_width = a_case.ruler.profile_bin,
                         .reach = g->length});
  }
  if (std::holds_alternative<HeapGeometry>(geometry)) {
    return measure_pile(a_case, series,
                        {.shape = analysis::ConicalHeap{{0.0, 0.0}}, .bin_width = a_case.ruler.profile_bin});
  }
  return measure_outflow(a_case, series, thickness);
}

}  // namespace talus::dem
