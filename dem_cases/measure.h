// What is measured of a gravity-driven case, whichever code ran it: the ruler that belongs to its kind.
#pragma once

#include <nlohmann/json.hpp>

#include "analysis/body_track.h"
#include "analysis/snapshot.h"
#include "dem_cases/case.h"

namespace talus::dem {

/// {"observables": {name: number}, "curves": {name: [numbers]}, "final_profile": {"x", "depth"}}, SI units, angles in degrees;
/// lengths of deposits over L0 or R0 as their rulers say. `thickness`: m, of what the code ran, in quasi-2-D; masses are
/// scaled to that of the case.
/// A figure that the series does not give is null.
/// - column_collapse, cylinder_collapse: analysis/observables/{column,cylinder}_collapse.h
/// - slot, hourglass: discharge_rate (kg/s, with its ..._error), flatness, residual, emptied_time; of the mass above the opening
/// - impact: analysis/observables/impact.h; it needs the sphere's track
/// - ledge, heap: repose_angle (with ..._fit_error, ..._sector_deviation), crest_height; still_leaving, the share of the pile that left
///   it over the last tenth of the time; rest_energy, its kinetic energy / (m g d) at the end; at_rest, of both
/// Throws SnapshotError.
nlohmann::json measure(const Case& a_case, const analysis::SnapshotSeries& series, double thickness,
                       const analysis::BodyTrack& track = {});

}  // namespace talus::dem
