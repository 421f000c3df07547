// A = D1^T M^-1 D1 on the active cells as what it is, a graph Laplacian with at most one link a side:
//
//   (A x)_c = diagonal_c x_c - sum over directions of link x_neighbour,   link = a_f^2 / m_f of the face between
//
// A neighbour that is not active holds x = 0 (the free surface); a wall has no link. Cells are in the order of level 0 of
// CellLevels; their fields have one more entry, 0, for the neighbour that is not there.
#pragma once

#include "continuum/grid/operators.h"
#include "continuum/stress/body_coupling.h"
#include "continuum/stress/cell_levels.h"

namespace talus {

/// U of A = Laplacian + U U' (body_coupling.h), by the cells that bodies touch, each of one body.
struct LowRank {
  std::vector<int> cells;     // by place in the levels
  std::vector<BodyRow> rows;  // U of each, by mode; 0 for modes that cannot be moved
  Eigen::Index modes = 0;
  Field
      majorant;  // of each of `cells`: row sums of |U U'|, so that diag(majorant) - U U' is positive semidefinite

  Field transpose_times(const Field& x) const;
  void add_times(const Field& y, Field& x) const;
};

struct CellLaplacian {
  Field links;     // per direction of CellLevels, a value for each cell; 0 where there is no neighbour
  Field surface;   // the links of each cell to x = 0 beyond the free surface
  Field diagonal;  // the sum of all links
  // Of the diagonal, and in cells that bodies touch of the majorant too: what a sweep must divide by to lower the energy. 0
  // for cells walled in on every side: nothing moves with their x.
  Field inverse_diagonal;
  LowRank bodies;
};

/// `inverse_mass` has open_faces + 1 entries, 1/kg.
CellLaplacian make_cell_laplacian(const ActiveRegion& region, const CellLevels& cells,
                                  const Field& inverse_mass, const BodyCoupling& bodies = {});

/// product = A x + constant (cells + 1 each).
void multiply(const CellLevels& cells, const CellLaplacian& laplacian, const Field& x, const Field& constant,
              Field& product);

/// What a step along a direction d does.
struct StepMeasure {
  double curvature = 0.0;  // d'A d
  double slope = 0.0;      // d'g
  double feasible = 0.0;   // x + t d >= 0 for 0 <= t <= feasible; may be infinite
};
/// product = A d, and what a step from x with the gradient g does.
StepMeasure multiply_and_measure(const CellLevels& cells, const CellLaplacian& laplacian,
                                 const Field& direction, const Field& x, const Field& gradient,
                                 Field& product);

/// One Gauss-Seidel sweep on 1/2 x'A x + b'x over x >= 0, colour by colour; what couples cells through bodies is replaced by
/// its majorant about the x it starts from. Never raises the energy. `linear` is changed meanwhile.
void relax_nonnegative(const CellLevels& cells, const CellLaplacian& laplacian, Field& linear, Field& x);

/// Calls f with the number of directions, 0, 2, 4 or 6, as a constant: loops over them are unrolled.
template <class Function>
void with_directions(std::size_t directions, const Function& f) {
  if (directions == 6) f(std::integral_constant<int, 6>{});
  if (directions == 4) f(std::integral_constant<int, 4>{});
  if (directions == 2) f(std::integral_constant<int, 2>{});
  if (directions == 0) f(std::integral_constant<int, 0>{});
}

}  // namespace talus
