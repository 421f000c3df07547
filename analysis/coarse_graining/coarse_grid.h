// The regular grid that grains are coarse-grained on: the continuum's own grid, so that both can be held side by side.
#pragma once

#include <Eigen/Core>
#include <array>

namespace talus::analysis {

/// What bounds the grid along an axis, on both sides.
enum class Edge {
  wall,      // nothing passes: the kernel is folded back at the outer faces
  periodic,  // the last cell is followed by the first
};

/// Fields live at cell centres, origin + (i + 1/2) spacing. Cell (i, j, k) is entry i + cells.x() (j + cells.y() k).
struct CoarseGrid {
  Eigen::Vector3d origin;   // m, the lowest corner
  Eigen::Vector3d spacing;  // m
  Eigen::Array3i cells;
  std::array<Edge, 3> edges;

  Eigen::Index count() const { return static_cast<Eigen::Index>(cells.x()) * cells.y() * cells.z(); }
  double cell_volume() const { return spacing.prod(); }
  double length(int axis) const { return spacing[axis] * cells[axis]; }
  Eigen::Index index(int i, int j, int k) const {
    return i + static_cast<Eigen::Index>(cells.x()) * (j + static_cast<Eigen::Index>(cells.y()) * k);
  }
};

/// Throws std::invalid_argument for a spacing that is not positive, no cells, or an origin that is not finite.
void check_grid(const CoarseGrid& grid);

}  // namespace talus::analysis
