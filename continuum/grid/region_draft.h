// An active region in the making: the parts that build it, in their order. Only for active_region.cpp and region_*.cpp.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "continuum/grid/active_region.h"

namespace talus {

inline constexpr std::ptrdiff_t cells_per_block = 512;  // of loops over threads

struct RegionDraft {
  const DomainSides& sides;
  const Openings& openings;
  ActiveRegion region;
  std::vector<Eigen::Vector3i> places;         // of cells
  std::vector<std::array<int, 6>> every_face;  // of cells: as cell_faces, with wall faces; -1 where closed
  std::vector<int> face_dense;                 // of open faces
  std::vector<Eigen::Vector3i> wall_places;    // of wall faces

  const Grid& grid() const { return region.grid; }
  Eigen::Vector3i place(int cell) const { return places[static_cast<std::size_t>(cell)]; }
  /// The active cell at an offset from a cell; -1 where there is none.
  int neighbour(int cell, int local) const {
    return region.cell_neighbours[static_cast<std::size_t>(cell)][static_cast<std::size_t>(local)];
  }
};

inline int parity_of(const Eigen::Vector3i& place) { return place.sum() & 1; }

/// Dense index of a point whose indices are in range but perhaps for one row beyond a periodic axis.
inline int dense_of(const Eigen::Vector3i& place, const Eigen::Vector3i& extent) {
  Eigen::Vector3i i;
  for (int axis = 0; axis < 3; ++axis)
    i[axis] = place[axis] < extent[axis] ? place[axis] : place[axis] - extent[axis];
  return i[0] + extent[0] * (i[1] + extent[1] * i[2]);
}

/// Cells and their neighbours; then faces, edges, what solids leave open, and stencils, each of what stands before it.
void find_neighbours(RegionDraft& draft);
void number_faces(RegionDraft& draft);
void number_edges(RegionDraft& draft);
void measure_solids(RegionDraft& draft);
void tabulate_stencils(RegionDraft& draft);

}  // namespace talus
