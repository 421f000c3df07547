// A recorded friction problem on its sparse K, and APGD on it: what the studies of solvers share.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "continuum/qp/cone_projection.h"
#include "continuum/qp/problem.h"
#include "continuum/qp/problem_file.h"

namespace talus::study {

using Array = Eigen::ArrayXd;
using Columns = Eigen::SparseMatrix<double>;
using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

inline constexpr double longest = 15.0;  // s of CPU time a solve may take

inline double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Work {
  explicit Work(ConeQp given)
      : problem(std::move(given)),
        k(problem.k),
        transposed(problem.k.transpose()),
        inverse_mass((problem.mass > 0.0).select(problem.mass.max(1e-300).inverse(), 0.0)) {
    curvature = Array(problem.balls.values());
    problem.balls.for_each([&](Eigen::Index block, Eigen::Index offset, int size) {
      curvature.segment(offset, size) = problem.balls.curvature[block];
    });
  }
  ConeQp problem;
  Rows k, transposed;
  Array inverse_mass, curvature;

  Array velocity(const Array& s) const {
    return problem.free_velocity + inverse_mass * (k * s.matrix()).array();
  }
  Array strain(const Array& v) const { return (transposed * v.matrix()).array(); }
  double dot(const Array& a, const Array& b) const { return (problem.mass * a * b).sum(); }
  void project(Array& s) const { project_onto_balls(problem.balls, s); }
  /// E(s) less the dual value at any velocity w: sum of r |e(w)| + s . e(w), and 1/2 |v(s) - w|^2_M.
  double gap(const Array& s, const Array& v, const Array& w) const {
    return duality_gap(problem.balls, s, strain(w)) + 0.5 * dot(v - w, v - w);
  }
  double gap(const Array& s) const {
    const Array v = velocity(s);
    return gap(s, v, v);
  }
};

struct Outcome {
  int iterations = 0;
  double seconds = 0.0, gap = 0.0;
  bool converged = false;
};

/// Counts iterations until a gap is small enough, a method has failed, or time is up.
class Watch {
 public:
  explicit Watch(double tolerance, int check_every = 5)
      : tolerance_(tolerance), check_every_(check_every), start_(cpu_seconds()) {}
  /// Whether to stop before iteration `iterations`; `gap()` is asked now and then.
  template <class Gap>
  bool stops(int iterations, const Gap& gap) {
    if (iterations % check_every_ != 0) return false;
    outcome_ = {iterations, cpu_seconds() - start_, gap(), false};
    outcome_.converged = outcome_.gap <= tolerance_;
    return outcome_.converged || !std::isfinite(outcome_.gap) || outcome_.seconds > longest ||
           iterations >= 5000;
  }
  const Outcome& outcome() const { return outcome_; }

 private:
  double tolerance_;
  int check_every_;
  double start_;
  Outcome outcome_;
};

enum class Momentum { none, accelerated, accelerated_mean };

/// Projected gradient, plain or accelerated with gradient restart. accelerated_mean stops by the gap at the mean velocity of
/// the steps since the last restart, weighted as the momentum weighs them.
template <class Look>
Outcome projected_gradient(const Work& work, double tolerance, Momentum kind, const Look& look) {
  Watch watch(tolerance);
  double lipschitz = std::max(smallest_lipschitz, 0.9 * work.problem.lipschitz), momentum = 1.0;
  Array s = work.problem.start;
  work.project(s);
  Array v = work.velocity(s), s_before = s, v_before = v, mean = v;
  double weight = 0.0;
  for (int iteration = 0;; ++iteration) {
    const auto gap = [&] {
      const double plain = work.gap(s, v, v);
      return kind == Momentum::accelerated_mean ? std::min(plain, work.gap(s, v, mean)) : plain;
    };
    look(iteration, s, v, mean);
    if (watch.stops(iteration, gap)) return watch.outcome();
    const double next = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * momentum * momentum));
    const double beta = kind == Momentum::none ? 0.0 : (momentum - 1.0) / next;
    const Array ahead = s + beta * (s - s_before), v_ahead = v + beta * (v - v_before),
                e = work.strain(v_ahead);
    weight += momentum;
    mean += momentum / weight * (v_ahead - mean);
    Array s_next, v_next;
    for (;;) {
      s_next = ahead - e / (lipschitz * work.curvature);
      work.project(s_next);
      v_next = work.velocity(s_next);
      const double taken = work.dot(v_next - v_ahead, v_next - v_ahead);
      const double allowed = lipschitz * (work.curvature * (s_next - ahead).square()).sum();
      if (!(taken > allowed * (1.0 + 1e-9) + 1e-26 * work.dot(v_ahead, v_ahead))) break;
      lipschitz = std::max(1.05 * taken / allowed, 1.2) * lipschitz;
    }
    const bool uphill = (e * (s_next - s)).sum() > 0.0;
    s_before = uphill ? s_next : s;
    v_before = uphill ? v_next : v;
    momentum = uphill ? 1.0 : next;
    if (uphill) weight = 0.0;
    s = s_next;
    v = v_next;
  }
}

inline ConeQp read_cone(const std::string& file) {
  const Problem problem = read_problem(file);
  if (!std::holds_alternative<ConeQp>(problem)) throw std::runtime_error(file + " is not a friction problem");
  return std::get<ConeQp>(problem);
}

}  // namespace talus::study
