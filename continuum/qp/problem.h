// A quadratic program of the solver as a value: all it takes to solve it again, away from the run it arose in.
//
//   BoundQp:  minimise 1/2 x'A x + b'x   subject to  lower <= x <= upper                            (mprgp.h)
//   ConeQp:   minimise E(s) = 1/2 ||v(s)||_M^2, v(s) = v_0 + M^-1 K s, subject to |s_b| <= r_b      (cone_projection.h)
//
// The solver itself is matrix-free; problems are only made to be recorded (problem_file.h) and solved again, by our
// solvers or by others. What is measured of a solution here is computed from the problem and the solution alone.
#pragma once

#include <Eigen/SparseCore>
#include <functional>
#include <optional>
#include <string>
#include <variant>

#include "continuum/qp/cone_projection.h"
#include "continuum/qp/mprgp.h"

namespace talus {

struct BoundQp {
  std::string name;                    // lower-case letters, digits and _: it becomes part of a file name
  Eigen::SparseMatrix<double> matrix;  // A, n x n, symmetric positive semidefinite
  Eigen::ArrayXd linear;               // b
  Eigen::ArrayXd lower, upper;         // may be infinite
  Eigen::ArrayXd start;                // x that the solver starts from
  double norm;                         // the spectrum of the diagonally scaled A lies in [0, norm]
  BoundQpSettings settings;            // tolerance in the units of b
};

struct ConeQp {
  std::string name;               // as of BoundQp
  Eigen::SparseMatrix<double> k;  // K, faces x values: impulse (N s) = K s
  Eigen::ArrayXd mass;            // M, kg; a face of mass 0 does not move
  Eigen::ArrayXd free_velocity;   // v_0, m/s
  BallBlocks balls;               // r_b in N s, d_b in 1/kg
  Eigen::ArrayXd start;           // s that the solver starts from, N s
  double lipschitz;               // L as it stood before the solve
  ConeProjectionSettings settings;
};

using Problem = std::variant<BoundQp, ConeQp>;

/// What solver code calls with each problem before it solves it. An empty one records nothing, and then no problem need
/// be made: `if (record) record(BoundQp{...});`
using ProblemRecorder = std::function<void(const Problem&)>;

/// What makes a problem unfit to be solved or stored, or nothing: sizes that disagree, a value that is not finite where it
/// must be, crossed bounds, an unsymmetric matrix, a negative mass or radius, a name that is no file name.
std::optional<std::string> find_defect(const Problem& problem);

/// A bound on the spectrum of the diagonally scaled matrix (Gershgorin): the largest row sum of |a_ij| / a_ii.
double scaled_norm_bound(const Eigen::SparseMatrix<double>& matrix);

struct BoundQpSolution {
  Eigen::ArrayXd x;
  BoundQpResult result;
};

struct ConeQpSolution {
  Eigen::ArrayXd s, velocity;  // N s, m/s
  double lipschitz;
  ConeProjectionResult result;
};

/// Solves from the problem's start with the problem's settings: the same bits every time. The problem has no defect.
BoundQpSolution solve(const BoundQp& problem);
ConeQpSolution solve(const ConeQp& problem);

/// 1/2 x'A x + b'x.
double objective(const BoundQp& problem, const Eigen::ArrayXd& x);
/// E(s), J.
double objective(const ConeQp& problem, const Eigen::ArrayXd& s);

/// The largest component of the projected gradient, in the units of b: 0 at a minimiser. Infinite where x is outside its
/// bounds.
double optimality_residual(const BoundQp& problem, const Eigen::ArrayXd& x);
/// E(s) less the value of the dual problem at v(s), J: at least E(s) - E(s*), 0 at a minimiser. Infinite where a block
/// of s is outside its ball by more than round-off.
double optimality_residual(const ConeQp& problem, const Eigen::ArrayXd& s);

}  // namespace talus
