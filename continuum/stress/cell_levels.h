// Coarser and coarser sets of an active region's cells, for multigrid (multigrid.h): index tables without coefficients.
//
// Level 0 holds the active cells, each further one the parents: cells twice as long along every axis that is still more
// than one cell long, wherever a child is active. Active cells are neighbours across an open face, parents where they lie
// side by side.
//
// Cells are ordered by colour, such that no two neighbours have the same one: two colours, as on a chessboard, and two more
// for the last plane along each periodic axis of odd length, which the chessboard does not close over.
#pragma once

#include <vector>

#include "continuum/grid/active_region.h"

namespace talus {

/// Cells a block of a loop holds, so that sums do not depend on the number of threads (parallel.h).
inline constexpr int cells_per_block = 2048;

struct CellLevel {
  int count = 0;
  std::vector<int> colour_begin;  // colour c: cells colour_begin[c] up to colour_begin[c + 1]
  // Per direction of CellLevels::directions, `count` each: the neighbour, `count` where there is none.
  std::vector<int> neighbours;
  std::vector<int> parent;                    // on the next level; empty on the last
  std::vector<int> children, children_begin;  // on the level before, ascending; empty on level 0

  int colours() const { return static_cast<int>(colour_begin.size()) - 1; }
  int last_colour_begin() const { return colour_begin[colour_begin.size() - 2]; }
};

struct CellLevels {
  // 2 * axis for below, 2 * axis + 1 for above; only of axes more than one cell long.
  std::vector<int> directions;
  std::vector<CellLevel> levels;
  std::vector<int> order;                   // of the region's cells: their place on level 0
  std::vector<std::array<bool, 3>> halved;  // per level but the last: the axes along which parents are longer
};

CellLevels make_cell_levels(const ActiveRegion& region);

}  // namespace talus
