// A discharge corrected for what a continuum cannot know: the size of grains.
//
//   W = C rho_b sqrt(g) w (D - k d)^(3/2)      slot of depth w             (Beverloo, Leniger & van de Velde 1961)
//   W = C rho_b sqrt(g) (D - k d)^(5/2)        round hole
//
// No grain's centre passes within k d / 2 of an edge. A continuum has no d, so its raw rate is that of k = 0, and too large by (1 - k d / D)^(-3/2)
// for that reason alone: 31 % at D = 8 d. C is what is left to compare: beverloo_C, with k = 0 for the continuum and 1.4 for grains (spheres; Nedderman
// 1992, chapter 10). Raw rate and C are separate observables, each with its own verdict.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "dem_cases/case.h"

namespace talus::validation {

inline constexpr double edge_width = 1.4;  // k, of spheres
inline constexpr double edge_width_uncertainty =
    0.2;  // half-width: 1.2 to 1.4 were fitted to slots of these grains (dem.md)

/// Adds beverloo_C to the observables of a run of a slot or hourglass; other runs are left as they are.
void add_beverloo_C(const dem::Case& a_case, nlohmann::json& run);

/// The relative standard uncertainty of beverloo_C of grains that k brings: a rectangular distribution.
double edge_width_effect(const dem::Case& a_case);

}  // namespace talus::validation
