// Points sorted by the cells they lie in: what lets loops over particles walk memory in order and work cell by cell.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "continuum/grid/grid.h"
#include "continuum/grid/sparse_index.h"

namespace talus {

struct PointsByCell {
  std::vector<int> cells;  // dense indices of the cells that hold points, ascending
  std::vector<int> first;  // cells + 1: the points of cells[c] have places first[c] up to first[c + 1]
  std::vector<int>
      order;  // the point at each place, those of one cell in their own order; empty where place = point
  SparseIndex cell_of_dense;  // index into `cells`; -1 where there is none

  int cell_count() const { return static_cast<int>(cells.size()); }
  int point_count() const { return first.back(); }
  int point(int place) const { return order.empty() ? place : order[static_cast<std::size_t>(place)]; }
};

/// `positions`: 3 x n, m. Points outside the domain are in no cell.
PointsByCell points_by_cell(const Grid& grid, const Eigen::Matrix3Xd& positions);

}  // namespace talus
