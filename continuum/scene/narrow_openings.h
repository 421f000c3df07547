// Openings between walls that are too narrow for the grid.
//
// Let d be the distance to the nearest wall. Where d is sampled at the corners of cells and these are added from the largest d
// down, each room of the domain grows from its middle, and two rooms meet in the widest passage between them, at its
// middle: a saddle of d. (The merge tree of d; what is outside of each open side of the domain counts as a room.) A passage is
// reported only where both rooms are wider than it by 3 cells, so that rough walls and slanted channels are not taken for
// openings: what lies between rooms that are hardly wider goes unnoticed, and so do all ways but the widest from one room to another.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "continuum/grid/boundary.h"
#include "continuum/solids/wall.h"

namespace talus {

struct NarrowOpening {
  Eigen::Vector3d place;  // m, near its middle
  double width;           // m, from wall to wall, across
};

/// Of gaps that no corner of a cell lies in, and that the grid therefore closes, one is told, if it is half a cell wide or more.
/// Passages narrower than `least_width` (m) between walls that never open, with domain sides that are walls; the narrowest first.
std::vector<NarrowOpening> narrow_openings(const Grid& grid, const DomainSides& sides,
                                           std::span<const Wall> walls, double least_width);

}  // namespace talus
