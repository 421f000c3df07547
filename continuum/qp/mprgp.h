// MPRGP, modified proportioning with reduced gradient projections (Dostal & Schoberl 2005), with two-sided
// bounds.
//
//   minimise 1/2 x'A x + b'x   subject to  lower <= x <= upper,   A symmetric positive semidefinite.
//
// Stops when the largest component of the projected gradient is below `tolerance`, in the units of b. The
// diagonal of A scales the variables; bounds stay bounds.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

namespace talus {

struct BoundQpResult {
  int iterations = 0;
  double residual = 0.0;   // largest projected gradient component at the end
  bool converged = false;  // false when the cap was hit
};

struct BoundQpSettings {
  double tolerance;
  int max_iterations;
};

/// `apply(x, Ax)` computes A x. `x` enters as the warm start (projected onto the bounds) and leaves as the
/// minimiser. `diagonal` is the diagonal of A, all > 0. The spectrum of the diagonally scaled A must lie in
/// [0, norm].
template <class Apply>
BoundQpResult minimise_bound_qp(const Apply& apply, const Eigen::ArrayXd& b, const Eigen::ArrayXd& lower,
                                const Eigen::ArrayXd& upper, const Eigen::ArrayXd& diagonal, double norm,
                                const BoundQpSettings& settings, Eigen::ArrayXd& x) {
  using Array = Eigen::ArrayXd;
  constexpr double proportioning = 1.0;  // Gamma: free and chopped gradient weigh the same
  const double fixed_step = 1.9 / norm;  // alpha-bar in (0, 2/||A||]

  // In scaled variables y = x / scale the matrix has a unit diagonal.
  const Array scale = diagonal.rsqrt();
  const Array low = lower / scale, high = upper / scale;
  Array y = (x / scale).max(low).min(high);
  Array ap(b.size()), product(b.size()), scaled(b.size());
  const auto multiply = [&](const Array& in, Array& out) {
    scaled = scale * in;
    apply(scaled, product);
    out = scale * product;
  };
  Array gradient(b.size());
  const auto refresh_gradient = [&] {
    multiply(y, gradient);
    gradient += scale * b;
  };

  Array free(b.size()), chopped(b.size());
  const auto split_gradient = [&] {
    const auto at_low = y <= low, at_high = y >= high;
    free = (at_low || at_high).select(0.0, gradient);
    // A variable whose bounds coincide cannot move, whatever its gradient.
    chopped = (at_low && at_high)
                  .select(0.0, at_low.select(gradient.min(0.0), at_high.select(gradient.max(0.0), 0.0)));
  };
  const auto largest_step = [&](const Array& direction) {  // largest alpha with y - alpha direction feasible
    double alpha = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      if (direction[i] > 0.0) alpha = std::min(alpha, (y[i] - low[i]) / direction[i]);
      if (direction[i] < 0.0) alpha = std::min(alpha, (y[i] - high[i]) / direction[i]);
    }
    return alpha;
  };

  refresh_gradient();
  split_gradient();
  Array direction = free;
  BoundQpResult result;
  for (;; ++result.iterations) {
    result.residual = ((free + chopped) / scale).abs().maxCoeff();
    result.converged = result.residual <= settings.tolerance;
    if (result.converged || result.iterations >= settings.max_iterations) break;

    const Array reduced =
        (gradient > 0.0)
            .select(((y - low) / fixed_step).min(gradient), ((y - high) / fixed_step).max(gradient));
    const bool proportional =
        chopped.square().sum() <= proportioning * proportioning * (free * reduced).sum();
    if (!proportional) direction = chopped;
    multiply(direction, ap);
    const double curvature = (direction * ap).sum();
    const double exact =
        curvature > 0.0 ? (gradient * direction).sum() / curvature : std::numeric_limits<double>::infinity();
    const double feasible = largest_step(direction);
    if (!proportional || exact <= feasible) {
      const double alpha = std::min(exact, feasible);
      if (!std::isfinite(alpha)) break;  // unbounded below along a null vector: no minimiser
      y = (y - alpha * direction).max(low).min(high);
      gradient -= alpha * ap;
      split_gradient();
      direction = proportional ? Array(free - (free * ap).sum() / curvature * direction) : free;
    } else {
      y = (y - feasible * direction).max(low).min(high);
      gradient -= feasible * ap;
      split_gradient();
      y = (y - fixed_step * free).max(low).min(high);
      refresh_gradient();
      split_gradient();
      direction = free;
    }
  }
  // Scaling back may miss a bound by a rounding; what is at its bound is at it exactly.
  x = (y <= low).select(lower, (y >= high).select(upper, (scale * y).max(lower).min(upper)));
  return result;
}

}  // namespace talus
