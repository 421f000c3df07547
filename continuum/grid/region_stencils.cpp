// The stencils of grid/stencil.h, of all points of a cell at once (active_region.h).
#include <algorithm>

#include "continuum/grid/region_draft.h"
#include "continuum/parallel.h"

namespace talus {
namespace {

using Eigen::Vector3i;

/// What is added to local_neighbour by an offset along each axis: 0 where that would leave the domain.
using Offsets = std::array<std::array<int, 3>, 3>;

Offsets offsets_inside(const Grid& grid, const Vector3i& place) {
  Offsets offsets{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    if (grid.periodic[a] || place[axis] > 0) offsets[a][0] = -neighbour_stride[a];
    if (grid.periodic[a] || place[axis] + 1 < grid.cells[axis]) offsets[a][2] = neighbour_stride[a];
  }
  return offsets;
}

/// Whether all 27 cells are active: then nothing but closed faces needs redirecting.
bool is_surrounded(const RegionDraft& draft, int cell, const Offsets& offsets) {
  for (const auto& along : offsets) {
    if (along[0] == 0 || along[2] == 0) return false;
  }
  const auto& neighbours = draft.region.cell_neighbours[static_cast<std::size_t>(cell)];
  int lowest = 0;
  for (const int neighbour : neighbours) lowest = std::min(lowest, neighbour);
  return lowest == 0;
}

void tabulate_cells(const RegionDraft& draft, int cell, const Offsets& offsets,
                    std::array<int, 27>& entries) {
  for (std::size_t local = 0; local < 27; ++local) {
    const int at = 13 + offsets[0][local % 3] + offsets[1][local / 3 % 3] + offsets[2][local / 9];
    entries[local] = draft.neighbour(cell, at);
    if (entries[local] >= 0) continue;
    entries[local] = empty_entry;
    if (!draft.openings.any()) continue;
    Vector3i place = draft.place(cell);
    for (std::size_t axis = 0; axis < 3; ++axis)
      place[static_cast<int>(axis)] += offsets[axis][(axis == 0   ? local
                                                      : axis == 1 ? local / 3
                                                                  : local / 9) %
                                                     3] /
                                       neighbour_stride[axis];
    // The weight of a cell that solids fill stays with the own cell.
    if (draft.openings.cell_share(draft.grid().cell_index(place)) == 0.0) entries[local] = cell;
  }
}

/// The face of `side` along `axis` of the cell at a local neighbour, active or not; negative where it cannot be used.
int face_at(const RegionDraft& draft, int cell, int local, std::size_t axis, std::size_t side) {
  const int neighbour = draft.neighbour(cell, local);
  if (neighbour >= 0) return draft.every_face[static_cast<std::size_t>(neighbour)][2 * axis + side];
  const int beyond = draft.neighbour(cell, local + (side ? neighbour_stride[axis] : -neighbour_stride[axis]));
  return beyond < 0 ? -1 : draft.every_face[static_cast<std::size_t>(beyond)][2 * axis + 1 - side];
}

void tabulate_faces(const RegionDraft& draft, int cell, const Offsets& offsets, std::size_t axis,
                    std::array<int, 18>& entries) {
  const auto next = static_cast<std::size_t>(next_axis(static_cast<int>(axis))),
             last = static_cast<std::size_t>(last_axis(static_cast<int>(axis)));
  const auto& own = draft.every_face[static_cast<std::size_t>(cell)];
  for (std::size_t side = 0; side < 2; ++side) {
    int fallback = own[2 * axis + side] >= 0 ? own[2 * axis + side] : own[2 * axis + 1 - side];
    if (fallback < 0) fallback = draft.region.null_face();
    for (std::size_t k = 0; k < 9; ++k) {
      const int face = face_at(draft, cell, 13 + offsets[next][k % 3] + offsets[last][k / 3], axis, side);
      entries[9 * side + k] = face >= 0 ? face : fallback;
    }
  }
}

/// The same where the cell is surrounded.
void tabulate_inner_faces(const RegionDraft& draft, int cell, std::size_t axis,
                          std::array<int, 18>& entries) {
  const auto& neighbours = draft.region.cell_neighbours[static_cast<std::size_t>(cell)];
  const auto next = static_cast<std::size_t>(neighbour_stride[(axis + 1) % 3]),
             last = static_cast<std::size_t>(neighbour_stride[(axis + 2) % 3]);
  int lowest = 0;
  for (std::size_t k = 0; k < 9; ++k) {
    const int neighbour = neighbours[13 - next - last + next * (k % 3) + last * (k / 3)];
    const auto& faces = draft.every_face[static_cast<std::size_t>(neighbour)];
    for (std::size_t side = 0; side < 2; ++side) {
      entries[9 * side + k] = faces[2 * axis + side];
      lowest = std::min(lowest, faces[2 * axis + side]);
    }
  }
  if (lowest < 0) tabulate_faces(draft, cell, offsets_inside(draft.grid(), draft.place(cell)), axis, entries);
}

}  // namespace

void tabulate_stencils(RegionDraft& draft) {
  ActiveRegion& region = draft.region;
  region.cell_stencils.resize(draft.places.size());
  for_each_block(region.cell_count(), cells_per_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (int cell = static_cast<int>(begin); cell < static_cast<int>(end); ++cell) {
      CellStencil& stencil = region.cell_stencils[static_cast<std::size_t>(cell)];
      const Offsets offsets = offsets_inside(draft.grid(), draft.place(cell));
      if (is_surrounded(draft, cell, offsets)) {
        stencil.cells = region.cell_neighbours[static_cast<std::size_t>(cell)];
        for (std::size_t axis = 0; axis < 3; ++axis)
          tabulate_inner_faces(draft, cell, axis, stencil.faces[axis]);
        continue;
      }
      tabulate_cells(draft, cell, offsets, stencil.cells);
      for (std::size_t axis = 0; axis < 3; ++axis)
        tabulate_faces(draft, cell, offsets, axis, stencil.faces[axis]);
    }
  });
}

}  // namespace talus
