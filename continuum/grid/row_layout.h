// The active region as rows along x, so that an operator's neighbours are at fixed distances along a row and loops over it
// run through memory.
//
// A node stands for a cell, for the faces at its lower sides and for the edges at its lower corner: they share its index.
// A row holds the nodes of one (j, k), from before its first to behind its last thing in use or read by a neighbour. What
// is not in use within it must hold values that do nothing: zero masks, inverse masses and yield radii.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "continuum/grid/active_region.h"
#include "continuum/grid/row_lanes.h"

namespace talus {

/// Loops along a row run over whole numbers of this many nodes: of float lanes, at least 8.
inline constexpr int row_padding = std::max(8, static_cast<int>(RowLanes<float>::size()));

struct Row {
  int begin, end;              // nodes: all of the row
  int items_begin, items_end;  // nodes that may be cells, faces or edges in use, padded
  int cells_begin, cells_end;  // nodes that may be cells in use: padded
  // By [dj + 1][dk + 1]: the number of the row there, 0 where there is none, and what to add to a node of this row for the
  // node beside it in that row.
  std::array<std::array<int, 3>, 3> neighbour, step;

  int length() const { return end - begin; }
  int to(int dj, int dk) const {
    return step[static_cast<std::size_t>(dj + 1)][static_cast<std::size_t>(dk + 1)];
  }
  int row_at(int dj, int dk) const {
    return neighbour[static_cast<std::size_t>(dj + 1)][static_cast<std::size_t>(dk + 1)];
  }
};

struct RowLayout {
  std::vector<Row> rows;  // row 0 stands for those that are not there: as long as any, nothing in use
  std::vector<int> first_row_of_task;  // rows in runs of about equal work, and the number of rows
  int nodes = 0;
  std::vector<int> node_of_cell;  // by the region's numbers
  std::vector<int> row_of_cell;
  std::vector<int> node_of_face;  // of open faces; 0 for the null face
  std::vector<int> node_of_edge;  // of inner and wall edges; 0 for the null edge
  int period = 0;                 // nodes a period along x is long; 0 where x is not periodic

  std::ptrdiff_t tasks() const { return static_cast<std::ptrdiff_t>(first_row_of_task.size()) - 1; }
};

RowLayout make_row_layout(const ActiveRegion& region);

}  // namespace talus
