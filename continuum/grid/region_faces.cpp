// Cells' neighbours and the numbering of faces (active_region.h).
#include <algorithm>

#include "continuum/grid/region_draft.h"
#include "continuum/parallel.h"

namespace talus {
namespace {

using Eigen::Vector3i;

struct Found {
  int dense;
  Vector3i place;
  int below, above;  // cells; -1 where not active
};

/// The domain side that a face lies on; null when it lies inside or on an open side.
const Side* wall_at(const RegionDraft& draft, int axis, const Vector3i& place) {
  const auto a = static_cast<std::size_t>(axis);
  if (draft.grid().periodic[a]) return nullptr;
  if (place[axis] == 0 && draft.sides[a][0].wall) return &draft.sides[a][0];
  if (place[axis] == draft.grid().cells[axis] && draft.sides[a][1].wall) return &draft.sides[a][1];
  return nullptr;
}

/// All faces of active cells along an axis, by their dense indices.
std::vector<Found> faces_of_cells(const RegionDraft& draft, int axis) {
  const int stride = neighbour_stride[static_cast<std::size_t>(axis)];
  const Vector3i extent = draft.grid().extent(Grid::nodal_of_face(axis));
  std::vector<Found> lower, caps;  // caps: upper faces below no active cell
  lower.reserve(draft.places.size());
  for (int cell = 0; cell < draft.region.cell_count(); ++cell) {
    const Vector3i place = draft.place(cell);
    lower.push_back({dense_of(place, extent), place, draft.neighbour(cell, 13 - stride), cell});
    if (draft.neighbour(cell, 13 + stride) >= 0) continue;
    const Vector3i up = place + Vector3i::Unit(axis);
    caps.push_back({dense_of(up, extent), up, cell, -1});
  }
  const auto ascending = [](const Found& a, const Found& b) { return a.dense < b.dense; };
  if (!std::is_sorted(caps.begin(), caps.end(), ascending)) std::sort(caps.begin(), caps.end(), ascending);
  std::vector<Found> all(lower.size() + caps.size());
  std::merge(lower.begin(), lower.end(), caps.begin(), caps.end(), all.begin(), ascending);
  return all;
}

void set_face(RegionDraft& draft, int axis, const Found& found, int face) {
  const auto side = static_cast<std::size_t>(2 * axis);
  if (found.below >= 0) draft.every_face[static_cast<std::size_t>(found.below)][side + 1] = face;
  if (found.above >= 0) draft.every_face[static_cast<std::size_t>(found.above)][side] = face;
  draft.region.face_of_dense[static_cast<std::size_t>(axis)].set(static_cast<std::size_t>(found.dense), face);
}

Vector3i offset_of(std::size_t local) {
  const int k = static_cast<int>(local);
  return {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
}

/// -1 outside the domain.
int dense_at_offset(const Grid& grid, const Vector3i& place, const Vector3i& offset) {
  Vector3i wrapped;
  for (int axis = 0; axis < 3; ++axis) wrapped[axis] = grid.wrapped(axis, place[axis] + offset[axis]);
  return grid.holds(wrapped) ? grid.cell_index(wrapped) : -1;
}

struct FoundWall {
  int axis;
  Found found;
  const Side* side;
};

/// Wall faces, numbered behind the null face.
void number_walls(RegionDraft& draft, const std::vector<FoundWall>& walls) {
  for (const auto& [axis, found, side] : walls) {
    const int face = draft.region.face_count();
    const bool upper = found.above < 0;
    set_face(draft, axis, found, face);
    draft.region.wall_faces.push_back({face,
                                       upper ? found.below : found.above,
                                       axis,
                                       upper ? -1.0 : 1.0,
                                       side->friction,
                                       draft.openings.face_share(axis, found.dense),
                                       {next_axis(axis), last_axis(axis)},
                                       {}});
    draft.wall_places.push_back(found.place);
  }
}

void tabulate_cell_faces(RegionDraft& draft) {
  ActiveRegion& region = draft.region;
  region.cell_faces.resize(draft.every_face.size());
  const auto open = [&](int face) {
    return face >= 0 && face < region.open_faces ? face : region.null_face();
  };
  for (std::size_t cell = 0; cell < draft.every_face.size(); ++cell)
    std::transform(draft.every_face[cell].begin(), draft.every_face[cell].end(),
                   region.cell_faces[cell].begin(), open);
}

}  // namespace

void find_neighbours(RegionDraft& draft) {
  ActiveRegion& region = draft.region;
  const Grid& grid = draft.grid();
  const auto count = region.dense_of_cell.size();
  region.cell_neighbours.resize(count);
  region.cell_parity.resize(count);
  draft.places.resize(count);
  std::array<int, 27> steps;  // of dense indices
  for (std::size_t local = 0; local < 27; ++local) {
    const Vector3i offset = offset_of(local);
    steps[local] = offset[0] + grid.cells[0] * (offset[1] + grid.cells[1] * offset[2]);
  }
  for_each_block(region.cell_count(), cells_per_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto cell = static_cast<std::size_t>(begin); cell < static_cast<std::size_t>(end); ++cell) {
      const int dense = region.dense_of_cell[cell];
      const Vector3i place = draft.places[cell] = grid.cell_of_index(dense);
      region.cell_parity[cell] = parity_of(place);
      const bool inner = (place.array() > 0).all() && (place.array() + 1 < grid.cells.array()).all();
      auto& neighbours = region.cell_neighbours[cell];
      for (std::size_t local = 0; local < 27; ++local) {
        const int at = inner ? dense + steps[local] : dense_at_offset(grid, place, offset_of(local));
        neighbours[local] = at < 0 ? -1 : region.cell_of_dense[static_cast<std::size_t>(at)];
      }
    }
  });
}

void number_faces(RegionDraft& draft) {
  ActiveRegion& region = draft.region;
  draft.every_face.assign(draft.places.size(), {-1, -1, -1, -1, -1, -1});
  std::vector<FoundWall> walls;
  for (int axis = 0; axis < 3; ++axis) {
    region.face_of_dense[static_cast<std::size_t>(axis)].reset(
        static_cast<std::size_t>(draft.grid().extent(Grid::nodal_of_face(axis)).prod()));
    for (const Found& found : faces_of_cells(draft, axis)) {
      if (draft.openings.face_share(axis, found.dense) == 0.0) continue;
      if (const Side* side = wall_at(draft, axis, found.place)) {
        walls.push_back({axis, found, side});
        continue;
      }
      set_face(draft, axis, found, region.open_faces++);
      region.face_axis.push_back(axis);
      const auto or_null = [&](int cell) { return cell < 0 ? region.null_cell() : cell; };
      region.face_cells.push_back({or_null(found.below), or_null(found.above)});
      draft.face_dense.push_back(found.dense);
    }
  }
  number_walls(draft, walls);
  tabulate_cell_faces(draft);
}

}  // namespace talus
