#include "continuum/qp/problem.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace talus {
namespace {

using Array = Eigen::ArrayXd;
using SparseMatrix = Eigen::SparseMatrix<double>;

constexpr double infinity = std::numeric_limits<double>::infinity();

bool is_file_name(std::string_view name) {
  const auto allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  return !name.empty() && std::all_of(name.begin(), name.end(), allowed);
}

bool is_finite(const SparseMatrix& matrix) {
  return Eigen::Map<const Array>(matrix.valuePtr(), matrix.nonZeros()).isFinite().all();
}

bool is_symmetric(const SparseMatrix& matrix) {
  constexpr double roundoff = 1e-12;  // of the largest entry; sums of products taken in another order
  const SparseMatrix transposed = matrix.transpose();
  return SparseMatrix(matrix - transposed).coeffs().abs().maxCoeff() <=
         roundoff * matrix.coeffs().abs().maxCoeff();
}

/// Collects the first thing that is wrong.
class Inspection {
 public:
  void require(bool holds, std::string_view otherwise) {
    if (!holds && !defect_) defect_ = otherwise;
  }
  void require_size(std::string_view what, const Array& array, Eigen::Index size) {
    require(array.size() == size, fmt::format("{} has {} values instead of {}", what, array.size(), size));
  }
  void require_finite(std::string_view what, const Array& array) {
    require(array.isFinite().all(), fmt::format("a value of {} is not finite", what));
  }
  /// Where sizes are wrong the values must not be looked at.
  bool sound() const { return !defect_; }
  std::optional<std::string> defect() const { return defect_; }

 private:
  std::optional<std::string> defect_;
};

Inspection inspect_frame(std::string_view name, double tolerance, int max_iterations) {
  Inspection inspection;
  inspection.require(is_file_name(name),
                     fmt::format("name '{}' is not made of lower-case letters, digits and _", name));
  inspection.require(tolerance >= 0.0 && std::isfinite(tolerance),
                     fmt::format("tolerance {} is not at least 0 and finite", tolerance));
  inspection.require(max_iterations >= 0, fmt::format("max_iterations {} is negative", max_iterations));
  return inspection;
}

std::optional<std::string> find_defect_of(const BoundQp& qp) {
  Inspection inspection = inspect_frame(qp.name, qp.settings.tolerance, qp.settings.max_iterations);
  const Eigen::Index n = qp.matrix.rows();
  inspection.require(n > 0, "it has no unknowns");
  inspection.require(qp.matrix.cols() == n, fmt::format("matrix is {} x {}", n, qp.matrix.cols()));
  inspection.require(qp.matrix.isCompressed(), "matrix is not compressed");
  inspection.require_size("linear", qp.linear, n);
  inspection.require_size("lower", qp.lower, n);
  inspection.require_size("upper", qp.upper, n);
  inspection.require_size("start", qp.start, n);
  if (!inspection.sound()) return inspection.defect();
  inspection.require(is_finite(qp.matrix), "a value of matrix is not finite");
  inspection.require(qp.matrix.nonZeros() == 0 || is_symmetric(qp.matrix), "matrix is not symmetric");
  inspection.require((qp.matrix.diagonal().array() >= 0.0).all(), "matrix has a negative diagonal entry");
  inspection.require_finite("linear", qp.linear);
  inspection.require_finite("start", qp.start);
  inspection.require(
      (qp.lower <= qp.upper).all() && (qp.lower < infinity).all() && (qp.upper > -infinity).all(),
      "a lower bound is above its upper bound, or a bound leaves no finite value");
  inspection.require(qp.norm > 0.0 && std::isfinite(qp.norm),
                     fmt::format("norm {} is not positive and finite", qp.norm));
  return inspection.defect();
}

std::optional<std::string> find_defect_of(const ConeQp& qp) {
  Inspection inspection = inspect_frame(qp.name, qp.settings.gap_tolerance, qp.settings.max_iterations);
  inspection.require(std::min(qp.balls.size[0], qp.balls.size[1]) >= 1, "balls has a size below 1");
  inspection.require(std::min(qp.balls.count[0], qp.balls.count[1]) >= 0, "balls has a negative count");
  // So that the number of values cannot overflow.
  inspection.require(qp.balls.count[0] <= qp.k.cols() && qp.balls.count[1] <= qp.k.cols(),
                     "balls has more blocks than values");
  inspection.require(qp.balls.size[0] <= std::max<Eigen::Index>(1, qp.k.cols()) &&
                         qp.balls.size[1] <= std::max<Eigen::Index>(1, qp.k.cols()),
                     "balls has a block larger than all values");
  inspection.require(qp.k.isCompressed(), "k is not compressed");
  if (!inspection.sound()) return inspection.defect();
  inspection.require(
      qp.balls.values() == qp.k.cols(),
      fmt::format("k has {} columns but the blocks hold {} values", qp.k.cols(), qp.balls.values()));
  inspection.require_size("radius", qp.balls.radius, qp.balls.blocks());
  inspection.require_size("curvature", qp.balls.curvature, qp.balls.blocks());
  inspection.require_size("mass", qp.mass, qp.k.rows());
  inspection.require_size("free_velocity", qp.free_velocity, qp.k.rows());
  inspection.require_size("start", qp.start, qp.k.cols());
  if (!inspection.sound()) return inspection.defect();
  inspection.require(is_finite(qp.k), "a value of k is not finite");
  inspection.require_finite("mass", qp.mass);
  inspection.require_finite("free_velocity", qp.free_velocity);
  inspection.require_finite("start", qp.start);
  inspection.require_finite("radius", qp.balls.radius);
  inspection.require_finite("curvature", qp.balls.curvature);
  inspection.require((qp.mass >= 0.0).all(), "a mass is negative");
  inspection.require((qp.balls.radius >= 0.0).all(), "a radius is negative");
  inspection.require((qp.balls.curvature > 0.0).all(), "a curvature is not positive");
  inspection.require(qp.lipschitz > 0.0 && std::isfinite(qp.lipschitz),
                     fmt::format("lipschitz {} is not positive and finite", qp.lipschitz));
  return inspection.defect();
}

Array inverse_mass(const ConeQp& qp) {
  return (qp.mass > 0.0).select(qp.mass.max(std::numeric_limits<double>::min()).inverse(), 0.0);
}

Array velocity_of(const ConeQp& qp, const Array& s) {
  return qp.free_velocity + inverse_mass(qp) * (qp.k * s.matrix()).array();
}

}  // namespace

std::optional<std::string> find_defect(const Problem& problem) {
  return std::visit([](const auto& qp) { return find_defect_of(qp); }, problem);
}

double scaled_norm_bound(const SparseMatrix& matrix) {
  double bound = 0.0;
  for (Eigen::Index column = 0; column < matrix.outerSize(); ++column) {
    double sum = 0.0, diagonal = 0.0;
    for (SparseMatrix::InnerIterator entry(matrix, column); entry; ++entry) {
      sum += std::abs(entry.value());
      if (entry.row() == column) diagonal = entry.value();
    }
    if (diagonal > 0.0) bound = std::max(bound, sum / diagonal);
  }
  return bound;
}

BoundQpSolution solve(const BoundQp& problem) {
  const auto apply = [&](const Array& x, Array& product) {
    product.matrix().noalias() = problem.matrix * x.matrix();
  };
  // A variable that nothing depends on has a zero row; any positive scale will do for it.
  const Array diagonal = problem.matrix.diagonal().array();
  const double smallest = std::max(1e-12 * diagonal.maxCoeff(), std::numeric_limits<double>::min());
  BoundQpSolution solution{problem.start, {}};
  solution.result = minimise_bound_qp(apply, problem.linear, problem.lower, problem.upper,
                                      diagonal.max(smallest), problem.norm, problem.settings, solution.x);
  return solution;
}

ConeQpSolution solve(const ConeQp& problem) {
  const auto apply = [&](const Array& s, Array& impulse) {
    impulse.matrix().noalias() = problem.k * s.matrix();
  };
  const auto apply_transpose = [&](const Array& velocity, Array& strain) {
    strain.matrix().noalias() = problem.k.transpose() * velocity.matrix();
  };
  ConeQpSolution solution{problem.start, problem.free_velocity, problem.lipschitz, {}};
  solution.result =
      project_onto_cone(apply, apply_transpose, problem.balls, problem.mass, problem.free_velocity,
                        problem.settings, solution.lipschitz, solution.s, solution.velocity);
  return solution;
}

double objective(const BoundQp& problem, const Array& x) {
  return 0.5 * x.matrix().dot(problem.matrix * x.matrix()) + (problem.linear * x).sum();
}

double objective(const ConeQp& problem, const Array& s) {
  return 0.5 * (problem.mass * velocity_of(problem, s).square()).sum();
}

double optimality_residual(const BoundQp& problem, const Array& x) {
  if (!(x >= problem.lower && x <= problem.upper).all()) return infinity;
  const Array gradient = (problem.matrix * x.matrix()).array() + problem.linear;
  // At a bound only what points away from the inside of the interval counts.
  const Array downhill = (x > problem.lower).select((-gradient).min(0.0), 0.0);
  const Array uphill = (x < problem.upper).select((-gradient).max(0.0), 0.0);
  return (downhill + uphill).abs().maxCoeff();
}

double optimality_residual(const ConeQp& problem, const Array& s) {
  constexpr double roundoff = 1e-12;  // of a radius, after one projection
  const Array velocity = velocity_of(problem, s);
  const Array strain = (problem.k.transpose() * velocity.matrix()).array();
  double gap = 0.0;
  problem.balls.for_each([&](Eigen::Index block, Eigen::Index offset, int size) {
    const double radius = problem.balls.radius[block];
    const auto stress = s.segment(offset, size).matrix();
    if (!(stress.norm() <= radius * (1.0 + roundoff))) gap = infinity;
    // What the block could dissipate at most at these velocities, less what it does.
    gap += radius * strain.segment(offset, size).matrix().norm() +
           stress.dot(strain.segment(offset, size).matrix());
  });
  return gap;
}

}  // namespace talus
