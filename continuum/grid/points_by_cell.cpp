#include "continuum/grid/points_by_cell.h"

#include <algorithm>

#include "continuum/parallel.h"

namespace talus {
namespace {

constexpr std::ptrdiff_t points_per_block = 4096;
constexpr int page_size = 64;

/// Of each point; -1 outside the domain.
std::vector<int> dense_cells_of(const Grid& grid, const Eigen::Matrix3Xd& positions) {
  std::vector<int> dense(static_cast<std::size_t>(positions.cols()));
  for_each_block(positions.cols(), points_per_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t p = begin; p < end; ++p) {
      const Eigen::Array3d lower = ((positions.col(p) - grid.origin) / grid.spacing).array().floor();
      const bool inside = (lower >= 0.0).all() && (lower < grid.cells.cast<double>().array()).all();
      const auto index = lower[0] + grid.cells[0] * (lower[1] + grid.cells[1] * lower[2]);  // exact
      dense[static_cast<std::size_t>(p)] = inside ? static_cast<int>(index) : -1;
    }
  });
  return dense;
}

}  // namespace

PointsByCell points_by_cell(const Grid& grid, const Eigen::Matrix3Xd& positions) {
  const auto domain = static_cast<std::size_t>(grid.cells.prod());
  const std::vector<int> dense = dense_cells_of(grid, positions);
  // Counts, by cell, of the pages of the domain that hold points.
  std::vector<int> page(domain / page_size + 1, -1);
  for (const int cell : dense) {
    if (cell >= 0) page[static_cast<std::size_t>(cell / page_size)] = 0;
  }
  int pages = 0;
  for (int& used : page) used = used < 0 ? -1 : page_size * pages++;
  std::vector<int> count(static_cast<std::size_t>(page_size * pages), 0);
  const auto slot = [&](int cell) {
    return static_cast<std::size_t>(page[static_cast<std::size_t>(cell / page_size)] + cell % page_size);
  };
  bool in_order = true;
  for (std::size_t p = 0; p < dense.size(); ++p) {
    in_order = in_order && dense[p] >= (p > 0 ? dense[p - 1] : 0);
    if (dense[p] >= 0) ++count[slot(dense[p])];
  }
  // Counts become the places where cells start.
  PointsByCell sorted;
  sorted.cell_of_dense = SparseIndex(domain);
  sorted.first.push_back(0);
  for (std::size_t d = 0; d < page.size(); ++d) {
    if (page[d] < 0) continue;
    for (int k = 0; k < page_size; ++k) {
      int& start = count[static_cast<std::size_t>(page[d] + k)];
      if (start == 0) continue;
      const int cell = page_size * static_cast<int>(d) + k, end = sorted.first.back() + start;
      start = sorted.first.back();
      sorted.cell_of_dense.set(static_cast<std::size_t>(cell), sorted.cell_count());
      sorted.cells.push_back(cell);
      sorted.first.push_back(end);
    }
  }
  if (in_order) return sorted;
  sorted.order.resize(static_cast<std::size_t>(sorted.point_count()));
  for (std::size_t p = 0; p < dense.size(); ++p) {
    if (dense[p] < 0) continue;
    sorted.order[static_cast<std::size_t>(count[slot(dense[p])]++)] = static_cast<int>(p);
  }
  return sorted;
}

}  // namespace talus
