// The part of the grid that holds particles, numbered compactly, with the tables that make the operators gathers.
//
// A cell is active when a particle lies in it; a cell that is not active is the free surface (p = 0, no other condition).
// Every table ends in a null entry (index = count) whose field value is always 0, so that a missing neighbour (free
// surface, wall) needs no branch: fields have one more entry than there are things. Fields, operators and the maps
// *_of_dense have the size of the active region. Cells, open faces (axis by axis) and inner edges (likewise) are numbered
// in the order of their dense indices: runs along x are contiguous.
//
// Faces:  the solver's unknown velocities are those of the open faces, all faces of active cells that are not on a wall.
//         Wall faces are numbered behind the null face; the solver sees them as null, their flux being zero.
// Edges:  an inner edge needs all four faces around it: where one is missing the edge lies on the free surface and
//         carries no traction. A wall edge lies on a frictional wall and couples the one face beside it to the wall.
// Copies: (method.md, section 5) each cell carries four copies of the stress, at the corners of one parity, which
//         alternates from cell to cell; each of its twelve edges is touched by exactly one of them. Each wall face
//         carries two copies of the wall traction in the same way, each contact with a solid four.
//
// Solids (openings.h) close faces, wholly or in part. A face they close is null, as on a wall. Where they cut a cell, a
// contact stands for the wall in it; and the normal strain across a face they close is that of a wall which stops the
// normal velocity and lets the tangential one slip (a closure), so that a uniform slip strains nothing and stress pushes
// on the wall along its normal only.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "continuum/grid/boundary.h"
#include "continuum/grid/grid.h"
#include "continuum/grid/openings.h"
#include "continuum/grid/points_by_cell.h"
#include "continuum/grid/sparse_index.h"

namespace talus {

inline constexpr int copies_per_cell = 4;
inline constexpr int copies_per_wall_face = 2;
inline constexpr int copies_per_contact = 4;
inline constexpr int values_per_contact = 2 * copies_per_contact;  // two tangential tractions a copy

/// Edge number within a cell: along `axis`, at offsets 0 or 1 along the next and the last axis.
constexpr int local_edge(int axis, int at_next, int at_last) { return 4 * axis + at_next + 2 * at_last; }

/// Number among the 27 cells around and including a cell, by offsets of -1, 0 or 1.
constexpr int local_neighbour(int x, int y, int z) { return 13 + x + 3 * y + 9 * z; }
/// What local_neighbour changes by with an offset along an axis.
constexpr std::array<int, 3> neighbour_stride{1, 3, 9};

/// Entry of a cell's stencil for the weight that falls on an empty cell.
inline constexpr int empty_entry = -1;

/// Where the trilinear kernels of points in a cell put their weights, redirected as grid/stencil.h says.
struct CellStencil {
  std::array<int, 27> cells;  // by local_neighbour; empty_entry where the cell is empty
  /// Per axis, at 9 * side + 3 * (1 + offset along last) + 1 + offset along next: face_of_dense; null where lost.
  std::array<std::array<int, 18>, 3> faces;
};

/// The corner (0 or 1 along x, y, z) at which a copy sits in a cell of the given parity.
std::array<int, 3> copy_corner(int parity, int copy);

struct WallFace {
  int face;                  // its index among all faces
  int cell;                  // the active cell beside it
  int axis;                  // its normal
  double inward;             // +1 when the inside lies up the axis, -1 otherwise
  double friction;           // mu_w; negative: as rough as the sand itself
  double area;               // what solids leave open of it, h^2
  std::array<int, 2> along;  // tangential axes: next and last of `axis`
  // Edges that carry the traction along `along[t]`, touched by copy 0 and copy 1; null where there is none.
  std::array<std::array<int, copies_per_wall_face>, 2> edges;
};

/// The wall of a solid inside an active cell.
struct Contact {
  int cell;
  Eigen::Vector3d normal;  // unit, into the sand
  double area;             // h^2
  double friction;         // mu_w; negative: as rough as the sand itself
  int body;                // whose surface it is; -1: a fixed wall's
  // The slip velocity at a copy's corner has its three components on these open faces; null where there is none.
  std::array<std::array<int, 3>, copies_per_contact> faces;
  Eigen::Matrix<double, 3, 2> tangents;  // orthonormal
};

/// Normal strain along an axis across which a solid closes a face of the cell:
/// (v_lower - v_upper) becomes - |n_axis| n . v, v the mean of the cell's open faces along each axis.
struct Closure {
  int cell;
  int axis;
  int body;                      // whose surface it is; -1: a fixed wall's
  double normal_share;           // |n_axis|
  Eigen::Vector3d normal;        // n, into the sand
  std::array<int, 6> faces;      // of the cell; null where not open
  std::array<double, 6> weight;  // strain = sum of weight * velocity
};

struct ActiveRegion {
  Grid grid;

  // Cells. dense_of_cell is ascending.
  std::vector<int> dense_of_cell;
  SparseIndex cell_of_dense;                         // -1 where not active
  std::vector<std::array<int, 27>> cell_neighbours;  // by local_neighbour; -1 where not active
  std::vector<CellStencil> cell_stencils;
  std::vector<std::array<int, 6>> cell_faces;   // x-, x+, y-, y+, z-, z+; null on walls
  std::vector<std::array<int, 12>> cell_edges;  // by local_edge; null where there is no inner edge
  std::vector<int> cell_parity;
  Eigen::ArrayXd cell_share;   // cells + 1: what solids leave open of the cell
  Eigen::ArrayXd cell_kernel;  // cells + 1: and of its deposition kernel

  // Faces: [0, open_faces) unknown, open_faces null, then wall faces up to face_count().
  int open_faces = 0;
  std::vector<int> face_axis;                  // of open faces
  std::vector<std::array<int, 2>> face_cells;  // of open faces: below, above; null where not active
  std::vector<std::array<int, 2>>
      face_strained_cells;     // the same, null where a closure stands for the strain
  Eigen::ArrayXd face_area;    // open_faces + 1: what solids leave open of the face, h^2
  Eigen::ArrayXd face_kernel;  // open_faces + 1: and of its deposition kernel
  std::vector<std::array<int, 4>>
      face_edges;  // of open faces: along `last` at next-, next+; along `next` at last-, last+
  std::array<SparseIndex, 3> face_of_dense;  // per axis, every face in use, wall faces too; -1 elsewhere
  std::vector<WallFace> wall_faces;
  std::vector<Contact> contacts;
  std::vector<Closure> closures;

  // Edges: [0, inner_edges) inner, then wall edges, then null = edge_faces.size().
  int inner_edges = 0;
  std::vector<int> edge_axis;
  std::vector<std::array<int, 4>>
      edge_faces;  // next-face at last-, last+; last-face at next-, next+ (of the edge's axis)
  std::vector<std::array<int, 4>>
      edge_copies;  // inner: cell * 4 + copy; wall: wall face * 2 + copy; -1 where none
  std::array<SparseIndex, 3> edge_of_dense;  // per axis; -1 elsewhere

  int cell_count() const { return static_cast<int>(dense_of_cell.size()); }
  int null_cell() const { return cell_count(); }
  int null_face() const { return open_faces; }
  int face_count() const { return open_faces + 1 + static_cast<int>(wall_faces.size()); }
  int edge_count() const { return static_cast<int>(edge_faces.size()); }
  int null_edge() const { return edge_count(); }
};

/// The region of the cells that hold `positions` (3 x n, m). Every position must lie inside the domain.
ActiveRegion make_active_region(const Grid& grid, const DomainSides& sides, const Eigen::Matrix3Xd& positions,
                                const Openings& openings = {});
/// The same, of points that are sorted already. `spent`: a region no longer needed, for its memory alone.
ActiveRegion make_active_region(const Grid& grid, const DomainSides& sides, const PointsByCell& points,
                                const Openings& openings = {}, ActiveRegion spent = {});

/// Takes from a region, to be spent on the next, most of its tables: all but those that tell where something lies, which
/// carrying over a stress from it reads. Nothing else may be asked of the region after.
ActiveRegion take_tables(ActiveRegion& from);

}  // namespace talus
