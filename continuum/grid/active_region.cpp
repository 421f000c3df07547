#include "continuum/grid/active_region.h"

#include "continuum/grid/region_draft.h"

namespace talus {
namespace {

/// For each parity and local edge, the one copy that touches it.
constexpr auto corner_table = [] {
  std::array<std::array<std::array<int, 3>, copies_per_cell>, 2> corners{};
  constexpr std::array<std::array<int, 3>, copies_per_cell> even{
      {{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}}};
  for (std::size_t copy = 0; copy < copies_per_cell; ++copy) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      corners[0][copy][axis] = even[copy][axis];
      corners[1][copy][axis] = 1 - even[copy][axis];
    }
  }
  return corners;
}();

/// Empty, in the memory it has. What is not cleared here is set as a whole by the parts that build it.
void clear(ActiveRegion& region) {
  region.open_faces = region.inner_edges = 0;
  region.face_axis.clear();
  region.face_cells.clear();
  region.wall_faces.clear();
  region.contacts.clear();
  region.closures.clear();
  region.edge_axis.clear();
  region.edge_faces.clear();
  region.edge_copies.clear();
}

}  // namespace

std::array<int, 3> copy_corner(int parity, int copy) {
  return corner_table[static_cast<std::size_t>(parity)][static_cast<std::size_t>(copy)];
}

ActiveRegion make_active_region(const Grid& grid, const DomainSides& sides, const PointsByCell& points,
                                const Openings& openings, ActiveRegion spent) {
  RegionDraft draft{sides, openings, std::move(spent), {}, {}, {}, {}};
  clear(draft.region);
  draft.region.grid = grid;
  draft.region.dense_of_cell = points.cells;
  draft.region.cell_of_dense = points.cell_of_dense;
  find_neighbours(draft);
  number_faces(draft);
  number_edges(draft);
  measure_solids(draft);
  tabulate_stencils(draft);
  return std::move(draft.region);
}

ActiveRegion make_active_region(const Grid& grid, const DomainSides& sides, const Eigen::Matrix3Xd& positions,
                                const Openings& openings) {
  return make_active_region(grid, sides, points_by_cell(grid, positions), openings);
}

ActiveRegion take_tables(ActiveRegion& from) {
  ActiveRegion tables;
  tables.cell_neighbours = std::move(from.cell_neighbours);
  tables.cell_stencils = std::move(from.cell_stencils);
  tables.cell_faces = std::move(from.cell_faces);
  tables.cell_edges = std::move(from.cell_edges);
  tables.cell_parity = std::move(from.cell_parity);
  tables.face_axis = std::move(from.face_axis);
  tables.face_cells = std::move(from.face_cells);
  tables.face_strained_cells = std::move(from.face_strained_cells);
  tables.face_edges = std::move(from.face_edges);
  tables.edge_axis = std::move(from.edge_axis);
  tables.edge_faces = std::move(from.edge_faces);
  tables.edge_copies = std::move(from.edge_copies);
  return tables;
}

}  // namespace talus
