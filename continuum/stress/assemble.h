// Sparse matrices of the matrix-free operators, for problems that are to be recorded (qp/problem.h).
//
// An operator is probed with vectors of ones: columns that share no row get the same colour (Curtis, Powell & Reid 1974),
// and one application serves all columns of a colour. So whatever the operator does is what stands in the matrix, and only
// where it may act (its pattern) is said twice. Cost: one application a colour, and per entry a look at its row. Colours:
// about 4 for D1, 9 for D2, 45 for the friction operator K, whatever the size of the grid; 20,000 cells take about a second.
//
// Matrices have no null entries: open_faces rows, cell_count() or edge_count() columns.
#pragma once

#include <Eigen/SparseCore>
#include <functional>
#include <vector>

#include "continuum/stress/friction.h"

namespace talus {

/// y = L x. Sizes of y and x are rows and columns of the pattern.
using LinearOperator = std::function<void(const Eigen::ArrayXd& x, Eigen::ArrayXd& y)>;

/// For each row of an operator, the columns that it may depend on, each once.
struct Pattern {
  Eigen::Index columns;
  std::vector<std::vector<int>> of_row;
};

/// The matrix of `apply`; what is 0 in it is left out. Throws std::logic_error when the operator does not stay within its
/// pattern, as one application to a dense vector tells.
Eigen::SparseMatrix<double> assemble(const LinearOperator& apply, const Pattern& pattern);

/// D1: open faces x cells.
Eigen::SparseMatrix<double> sparse_gradient(const ActiveRegion& region);
/// The part of D2 that acts on the stress component S_aa of cells, a = `axis`: open faces x cells.
Eigen::SparseMatrix<double> sparse_diagonal_divergence(const ActiveRegion& region, int axis);
/// The part of D2 that acts on shear stresses, wall edges too: open faces x edges.
Eigen::SparseMatrix<double> sparse_shear_divergence(const ActiveRegion& region);
/// The part of D2 that acts on the tractions at contacts with solids: open faces x values_per_contact each.
Eigen::SparseMatrix<double> sparse_contact_divergence(const ActiveRegion& region);
/// K: open faces x values of the copies. Columns of idle values (FrictionOperator::clear_idle) are empty.
Eigen::SparseMatrix<double> sparse_friction(const ActiveRegion& region, const FrictionOperator& friction,
                                            const BodyCoupling& bodies = no_bodies());

/// D^T diag(weight) D, symmetric to the last bit: with D1 and the inverse masses of the open faces, the matrix A of
/// solve_pressure.
Eigen::SparseMatrix<double> normal_matrix(const Eigen::SparseMatrix<double>& d, const Eigen::ArrayXd& weight);

}  // namespace talus
