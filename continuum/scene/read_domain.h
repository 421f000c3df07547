// The table [domain] of a scene, its [[wall]]s, and whether the grid can see them.
#pragma once

#include "continuum/files/checked_table.h"
#include "continuum/files/faults.h"
#include "continuum/scene/scene.h"

namespace talus {

/// Reads grid, sides and gravity into `scene`. Throws InputError, also for more cells than `limits` has.
void read_domain(const CheckedTable& root, const SceneLimits& limits, Scene& scene);

/// Reads all walls that can be read into `scene`; returns whether these are all.
bool read_walls(const CheckedTable& root, Faults& faults, Scene& scene);

/// Throws InputError for walls that are thinner than a cell where the grid would miss them, and for those that differ at the two
/// ends of a periodic axis.
void check_walls(const CheckedTable& root, const Scene& scene);

}  // namespace talus
