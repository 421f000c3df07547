// The numbering of edges, inner ones and those on walls (active_region.h).
#include <algorithm>
#include <optional>

#include "continuum/grid/region_draft.h"

namespace talus {
namespace {

using Eigen::Vector3i;

/// The four cells around an edge, by corner = at_next + 2 * at_last of the edge within them; -1 where not active.
using CellsAround = std::array<int, 4>;

struct Found {
  int dense;
  CellsAround cells;
  std::array<int, 4> faces;
};

/// copies[parity][axis][corner]: the copy of a cell that touches its edge there.
using TouchingCopies = std::array<std::array<std::array<int, 4>, 3>, 2>;

TouchingCopies touching_copies() {
  TouchingCopies copies{};
  for (int parity = 0; parity < 2; ++parity) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int copy = 0; copy < copies_per_cell; ++copy) {
        const auto at = copy_corner(parity, copy);
        const int corner =
            at[static_cast<std::size_t>(next_axis(axis))] + 2 * at[static_cast<std::size_t>(last_axis(axis))];
        copies[static_cast<std::size_t>(parity)][static_cast<std::size_t>(axis)]
              [static_cast<std::size_t>(corner)] = copy;
      }
    }
  }
  return copies;
}

class EdgeNumbering {
 public:
  EdgeNumbering(RegionDraft& draft, int axis)
      : draft_(draft),
        axis_(axis),
        next_(next_axis(axis)),
        last_(last_axis(axis)),
        extent_(draft.grid().extent(Grid::nodal_of_edge(axis))) {}

  /// In the order of dense indices. Each edge is found from the first active cell around it: its own, at corner 0, for most.
  void run() {
    draft_.region.edge_of_dense[static_cast<std::size_t>(axis_)].reset(
        static_cast<std::size_t>(extent_.prod()));
    std::vector<Found> others;
    for (int cell = 0; cell < draft_.region.cell_count(); ++cell) {
      for (int corner = 1; corner < 4; ++corner) {
        if (const auto found = find(cell, corner)) others.push_back(*found);
      }
    }
    std::sort(others.begin(), others.end(), [](const Found& a, const Found& b) { return a.dense < b.dense; });
    auto other = others.begin();
    for (int cell = 0; cell < draft_.region.cell_count(); ++cell) {
      const auto found = find(cell, 0);
      if (!found) continue;
      for (; other != others.end() && other->dense < found->dense; ++other) add(*other);
      add(*found);
    }
    for (; other != others.end(); ++other) add(*other);
  }

 private:
  int neighbour(int cell, int at_next, int at_last) const {
    return draft_.neighbour(cell, 13 + at_next * neighbour_stride[static_cast<std::size_t>(next_)] +
                                      at_last * neighbour_stride[static_cast<std::size_t>(last_)]);
  }

  /// An open face between two cells; null where neither is active.
  int face_between(int below, int above, int axis) const {
    const auto side = static_cast<std::size_t>(2 * axis);
    if (above >= 0) return draft_.region.cell_faces[static_cast<std::size_t>(above)][side];
    if (below >= 0) return draft_.region.cell_faces[static_cast<std::size_t>(below)][side + 1];
    return draft_.region.null_face();
  }

  /// The edge at a corner of a cell, if it is an inner one and no cell at a lower corner is active.
  std::optional<Found> find(int cell, int corner) const {
    const int at_next = corner & 1, at_last = corner >> 1;
    Found found;
    for (int other = 0; other < 4; ++other) {
      found.cells[static_cast<std::size_t>(other)] =
          neighbour(cell, at_next - (other & 1), at_last - (other >> 1));
      if (other < corner && found.cells[static_cast<std::size_t>(other)] >= 0) return std::nullopt;
    }
    const auto& c = found.cells;
    found.faces = {face_between(c[3], c[2], next_), face_between(c[1], c[0], next_),
                   face_between(c[3], c[1], last_), face_between(c[2], c[0], last_)};
    for (const int face : found.faces) {
      if (face == draft_.region.null_face()) return std::nullopt;
    }
    Vector3i place = draft_.place(cell);
    place[next_] += at_next;
    place[last_] += at_last;
    found.dense = dense_of(place, extent_);
    return found;
  }

  void add(const Found& found) {
    ActiveRegion& region = draft_.region;
    const int edge = region.edge_count();
    region.edge_of_dense[static_cast<std::size_t>(axis_)].set(static_cast<std::size_t>(found.dense), edge);
    region.edge_axis.push_back(axis_);
    region.edge_faces.push_back(found.faces);
    region.edge_copies.push_back(copies(found.cells));
    for (std::size_t corner = 0; corner < 4; ++corner) {
      if (found.cells[corner] < 0) continue;
      region.cell_edges[static_cast<std::size_t>(found.cells[corner])]
                       [4 * static_cast<std::size_t>(axis_) + corner] = edge;
    }
  }

  std::array<int, 4> copies(const CellsAround& cells) const {
    std::array<int, 4> touching;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const int cell = cells[corner];
      touching[corner] = -1;
      if (cell < 0) continue;
      const auto parity = static_cast<std::size_t>(draft_.region.cell_parity[static_cast<std::size_t>(cell)]);
      touching[corner] = cell * copies_per_cell + touching_[parity][static_cast<std::size_t>(axis_)][corner];
    }
    return touching;
  }

  RegionDraft& draft_;
  int axis_, next_, last_;
  Vector3i extent_;
  TouchingCopies touching_ = touching_copies();
};

/// The edge of a wall face that carries its traction along `tangent`, on the tangent's side `side`; made if need be.
int wall_edge(ActiveRegion& region, const WallFace& wall, const Vector3i& wall_place, int tangent, int axis,
              int side) {
  // The one unknown face beside this edge is tangential, half a cell inside the wall.
  const int beside =
      region.cell_faces[static_cast<std::size_t>(wall.cell)][static_cast<std::size_t>(2 * tangent + side)];
  if (beside == region.null_face()) return -1;
  const Vector3i place = wall_place + side * Vector3i::Unit(tangent);
  const auto dense = static_cast<std::size_t>(dense_of(place, region.grid.extent(Grid::nodal_of_edge(axis))));
  auto& edge_of_dense = region.edge_of_dense[static_cast<std::size_t>(axis)];
  if (edge_of_dense[dense] >= 0) return edge_of_dense[dense];
  const int edge = region.edge_count();
  edge_of_dense.set(dense, edge);
  std::array<int, 4> faces;
  faces.fill(region.null_face());
  faces[(tangent == next_axis(axis) ? 0u : 2u) + (wall.inward > 0 ? 1u : 0u)] = beside;
  region.edge_axis.push_back(axis);
  region.edge_faces.push_back(faces);
  region.edge_copies.push_back({-1, -1, -1, -1});
  return edge;
}

/// A wall face's traction along t lives on its two edges along the other tangential axis.
void number_wall_edges(RegionDraft& draft, int w) {
  ActiveRegion& region = draft.region;
  WallFace& wall = region.wall_faces[static_cast<std::size_t>(w)];
  const Vector3i place = draft.wall_places[static_cast<std::size_t>(w)];
  const int parity = parity_of(place);
  for (std::size_t t = 0; t < 2; ++t) {
    for (int copy = 0; copy < copies_per_wall_face; ++copy) {
      // Copies sit at opposite corners of the face: (0,0) and (1,1), or (0,1) and (1,0) for the other parity.
      const int corner = t == 0 ? copy : copy ^ parity;
      const int edge = wall_edge(region, wall, place, wall.along[t], wall.along[1 - t], corner);
      wall.edges[t][static_cast<std::size_t>(copy)] = edge;
      if (edge < 0) continue;
      auto& touching = region.edge_copies[static_cast<std::size_t>(edge)];
      *std::find(touching.begin(), touching.end(), -1) = w * copies_per_wall_face + copy;
    }
  }
}

void tabulate_face_edges(ActiveRegion& region) {
  const int null_edge = region.null_edge();
  region.face_edges.assign(static_cast<std::size_t>(region.open_faces),
                           {null_edge, null_edge, null_edge, null_edge});
  // A face below an edge has it at its upper side, and one above it at its lower side.
  constexpr std::array<std::size_t, 4> place_of_edge{1, 0, 3, 2};
  for (int edge = 0; edge < region.edge_count(); ++edge) {
    const auto& faces = region.edge_faces[static_cast<std::size_t>(edge)];
    for (std::size_t k = 0; k < 4; ++k) {
      if (faces[k] != region.null_face())
        region.face_edges[static_cast<std::size_t>(faces[k])][place_of_edge[k]] = edge;
    }
  }
}

}  // namespace

void number_edges(RegionDraft& draft) {
  ActiveRegion& region = draft.region;
  std::array<int, 12> none;
  none.fill(-1);
  region.cell_edges.assign(draft.places.size(), none);
  const std::size_t expected = draft.places.size() * 7 / 2;
  region.edge_axis.reserve(expected);
  region.edge_faces.reserve(expected);
  region.edge_copies.reserve(expected);
  for (int axis = 0; axis < 3; ++axis) EdgeNumbering(draft, axis).run();
  region.inner_edges = region.edge_count();
  for (std::size_t w = 0; w < region.wall_faces.size(); ++w) {
    if (region.wall_faces[w].friction != 0.0) number_wall_edges(draft, static_cast<int>(w));
  }
  const int null_edge = region.null_edge();
  for (auto& edges : region.cell_edges) std::replace(edges.begin(), edges.end(), -1, null_edge);
  for (WallFace& wall : region.wall_faces) {
    for (auto& edges : wall.edges) {
      for (int& edge : edges) edge = wall.friction != 0.0 && edge >= 0 ? edge : null_edge;
    }
  }
  tabulate_face_edges(region);
}

}  // namespace talus
