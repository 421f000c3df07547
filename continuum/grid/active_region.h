// The part of the grid that holds particles, numbered compactly, with the tables that make the operators gathers.
//
// A cell is active when a particle lies in it; a cell that is not active is the free surface (p = 0, no other condition).
// Every table ends in a null entry (index = count) whose field value is always 0, so that a missing neighbour (free
// surface, wall) needs no branch: fields have one more entry than there are things. Fields and operators have the size of
// the active region; the maps *_of_dense that find it have the size of the domain and are rebuilt each step.
//
// Faces:  the solver's unknown velocities are those of the open faces, all faces of active cells that are not on a wall.
//         Wall faces are numbered behind the null face; the solver sees them as null, their flux being zero.
// Edges:  an inner edge needs all four faces around it: where one is missing the edge lies on the free surface and
//         carries no traction. A wall edge lies on a frictional wall and couples the one face beside it to the wall.
// Copies: (method.md, section 5) each cell carries four copies of the stress, at the corners of one parity, which
//         alternates from cell to cell; each of its twelve edges is touched by exactly one of them. Each wall face
//         carries two copies of the wall traction in the same way.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "continuum/grid/boundary.h"
#include "continuum/grid/grid.h"

namespace talus {

inline constexpr int copies_per_cell = 4;
inline constexpr int copies_per_wall_face = 2;

/// Edge number within a cell: along `axis`, at offsets 0 or 1 along the next and the last axis.
constexpr int local_edge(int axis, int at_next, int at_last) { return 4 * axis + at_next + 2 * at_last; }

/// The corner (0 or 1 along x, y, z) at which a copy sits in a cell of the given parity.
std::array<int, 3> copy_corner(int parity, int copy);

struct WallFace {
  int face;                  // its index among all faces
  int cell;                  // the active cell beside it
  int axis;                  // its normal
  double inward;             // +1 when the inside lies up the axis, -1 otherwise
  double friction;           // mu_w
  std::array<int, 2> along;  // tangential axes: next and last of `axis`
  // Edges that carry the traction along `along[t]`, touched by copy 0 and copy 1; null where there is none.
  std::array<std::array<int, copies_per_wall_face>, 2> edges;
};

struct ActiveRegion {
  Grid grid;

  // Cells. dense_of_cell is ascending.
  std::vector<int> dense_of_cell;
  std::vector<int> cell_of_dense;               // -1 where not active
  std::vector<std::array<int, 6>> cell_faces;   // x-, x+, y-, y+, z-, z+; null on walls
  std::vector<std::array<int, 12>> cell_edges;  // by local_edge; null where there is no inner edge
  std::vector<int> cell_parity;

  // Faces: [0, open_faces) unknown, open_faces null, then wall faces up to face_count().
  int open_faces = 0;
  std::vector<int> face_axis;                  // of open faces
  std::vector<std::array<int, 2>> face_cells;  // of open faces: below, above; null where not active
  std::vector<std::array<int, 4>>
      face_edges;  // of open faces: along `last` at next-, next+; along `next` at last-, last+
  std::array<std::vector<int>, 3> face_of_dense;  // per axis, every face in use, wall faces too; -1 elsewhere
  std::vector<WallFace> wall_faces;

  // Edges: [0, inner_edges) inner, then wall edges, then null = edge_faces.size().
  int inner_edges = 0;
  std::vector<int> edge_axis;
  std::vector<std::array<int, 4>>
      edge_faces;  // next-face at last-, last+; last-face at next-, next+ (of the edge's axis)
  std::vector<std::array<int, 4>>
      edge_copies;  // inner: cell * 4 + copy; wall: wall face * 2 + copy; -1 where none

  int cell_count() const { return static_cast<int>(dense_of_cell.size()); }
  int null_cell() const { return cell_count(); }
  int null_face() const { return open_faces; }
  int face_count() const { return open_faces + 1 + static_cast<int>(wall_faces.size()); }
  int edge_count() const { return static_cast<int>(edge_faces.size()); }
  int null_edge() const { return edge_count(); }
};

/// The region of the cells that hold `positions` (3 x n, m). Every position must lie inside the domain.
ActiveRegion make_active_region(const Grid& grid, const DomainSides& sides,
                                const Eigen::Matrix3Xd& positions);

}  // namespace talus
