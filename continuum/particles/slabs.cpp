#include "continuum/particles/slabs.h"

namespace talus {

Slabs make_slabs(const Grid& grid, const PointsByCell& points) {
  Eigen::Vector3i lowest = grid.cells, highest = Eigen::Vector3i::Constant(-1);
  for (const int dense : points.cells) {
    const Eigen::Vector3i place = grid.cell_of_index(dense);
    lowest = lowest.cwiseMin(place);
    highest = highest.cwiseMax(place);
  }
  int axis =
      2;  // along which slabs follow each other; the last of equals, since memory runs along the others
  for (const int other : {1, 0}) {
    if (highest[other] - lowest[other] > highest[axis] - lowest[axis]) axis = other;
  }
  const int count = std::max(1, grid.cells[axis] / slab_rows);  // the last one takes what is left over
  std::vector<std::vector<int>> cells(static_cast<std::size_t>(count));
  for (int c = 0; c < points.cell_count(); ++c) {
    const int row = grid.cell_of_index(points.cells[static_cast<std::size_t>(c)])[axis];
    cells[static_cast<std::size_t>(std::min(row / slab_rows, count - 1))].push_back(c);
  }
  Slabs slabs;
  slabs.of_colour.resize(3);
  const bool odd_ring = grid.periodic[static_cast<std::size_t>(axis)] && count % 2 == 1;
  for (int slab = 0; slab < count; ++slab) {
    auto& own = cells[static_cast<std::size_t>(slab)];
    if (own.empty()) continue;
    const int colour = odd_ring && slab == count - 1 ? 2 : slab % 2;
    slabs.of_colour[static_cast<std::size_t>(colour)].push_back(static_cast<int>(slabs.cells.size()));
    slabs.cells.push_back(std::move(own));
  }
  return slabs;
}

}  // namespace talus
