// What is allowed in a scene and yet likely to give wrong results, or none: told before the run.
#pragma once

#include <string>
#include <vector>

#include "continuum/scene/cost.h"
#include "continuum/scene/scene.h"

namespace talus {

inline constexpr double least_opening = 6.0;     // cells across: across narrower ones too little flows
inline constexpr double least_layer = 1.0;       // cells: what is thinner has no inside on the grid
inline constexpr double least_body = 2.0;        // cells: the flow about smaller ones is not resolved
inline constexpr int least_particles_in_3d = 8;  // per cell: two along each axis
inline constexpr int least_particles_in_2d = 4;  // the same, in plane strain
inline constexpr double most_steps_expected = 1e6;

/// A line each, that begins with the scene's file and ends in what to do; with figures. `memory` is what is there, in bytes.
/// Openings are looked for in grids of up to 5e6 cells, as narrow_openings does.
std::vector<std::string> scene_warnings(const Scene& scene, const SceneCost& cost, double memory);

}  // namespace talus
