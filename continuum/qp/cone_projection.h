// The friction problem: of all stresses inside the yield surface, the one that leaves the least kinetic
// energy (5.20).
//
//   minimise E(s) = 1/2 ||v(s)||_M^2,  v(s) = v_0 + M^-1 K s,   subject to  |s_b| <= r_b  for every block b.
//
// Accelerated projected gradient with gradient restart, steps scaled per block by 1 / (L d_b); L adapts, so
// that no spectral bound has to be known. Stops on the duality gap, which is rigorous (method.md, section 5):
//   gap = sum_b (r_b |e_b| + s_b . e_b) >= E(s) - E(s*),   e = K^T v,   and   ||v - v*||_M^2 <= gap.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

namespace talus {

/// A vector made of two runs of equal blocks, each block confined to a ball: first all of size `size[0]`,
/// then `size[1]`.
struct BallBlocks {
  std::array<int, 2> size;
  std::array<Eigen::Index, 2> count;
  Eigen::ArrayXd radius;     // one per block
  Eigen::ArrayXd curvature;  // d_b > 0, an estimate of the largest second derivative of E in the block

  Eigen::Index blocks() const { return count[0] + count[1]; }
  Eigen::Index values() const { return size[0] * count[0] + size[1] * count[1]; }

  /// f(block, first value, number of values) for every block, in order.
  template <class Function>
  void for_each(Function&& f) const {
    Eigen::Index block = 0, offset = 0;
    for (std::size_t run = 0; run < 2; ++run) {
      for (Eigen::Index i = 0; i < count[run]; ++i, ++block, offset += size[run]) f(block, offset, size[run]);
    }
  }
};

inline void project_onto_balls(const BallBlocks& balls, Eigen::ArrayXd& s) {
  balls.for_each([&](Eigen::Index block, Eigen::Index offset, int size) {
    const double norm = std::sqrt(s.segment(offset, size).square().sum());
    const double radius = balls.radius[block];
    if (norm > radius) s.segment(offset, size) *= radius / norm;
  });
}

inline double duality_gap(const BallBlocks& balls, const Eigen::ArrayXd& s, const Eigen::ArrayXd& strain) {
  double gap = 0.0;
  balls.for_each([&](Eigen::Index block, Eigen::Index offset, int size) {
    const auto e = strain.segment(offset, size);
    gap += balls.radius[block] * std::sqrt(e.square().sum()) + (s.segment(offset, size) * e).sum();
  });
  return std::max(gap, 0.0);  // below 0 only by round-off
}

/// L of a block that acts alone, where the curvature is as FrictionOperator::blocks estimates it.
inline constexpr double smallest_lipschitz = 1.0;

struct ConeProjectionSettings {
  double gap_tolerance;  // J
  int max_iterations;
};

struct ConeProjectionResult {
  int iterations = 0;
  double gap = 0.0;  // J, at the end
  bool converged = false;
};

/// `apply(s, impulse)`: impulse = K s on the faces. `apply_transpose(v, strain)`: strain = K^T v. `s` enters
/// as the warm start and leaves as the minimiser, `velocity` leaves as v(s). `lipschitz` is L, kept between
/// calls.
template <class Apply, class ApplyTranspose>
ConeProjectionResult project_onto_cone(const Apply& apply, const ApplyTranspose& apply_transpose,
                                       const BallBlocks& balls, const Eigen::ArrayXd& mass,
                                       const Eigen::ArrayXd& free_velocity,
                                       const ConeProjectionSettings& settings, double& lipschitz,
                                       Eigen::ArrayXd& s, Eigen::ArrayXd& velocity) {
  using Array = Eigen::ArrayXd;
  constexpr int iterations_between_checks = 5;
  constexpr double roundoff = 1e-26;  // of a squared velocity; (2^-52)^2 is 5e-32, sums have many terms
  constexpr double lipschitz_decay =
      0.9;  // between calls, so that one hard step does not slow all later ones
  lipschitz = std::max(smallest_lipschitz, lipschitz_decay * lipschitz);
  const Array inverse_mass = (mass > 0.0).select(mass.max(1e-300).inverse(), 0.0);
  Array impulse(mass.size()), strain(s.size());
  const auto velocity_of = [&](const Array& stress, Array& v) {
    apply(stress, impulse);
    v = free_velocity + inverse_mass * impulse;
  };
  // Sum over blocks of d_b |a_b|^2.
  const auto scaled_norm = [&](const Array& a) {
    double sum = 0.0;
    balls.for_each([&](Eigen::Index block, Eigen::Index offset, int size) {
      sum += balls.curvature[block] * a.segment(offset, size).square().sum();
    });
    return sum;
  };

  project_onto_balls(balls, s);
  velocity_of(s, velocity);
  Array s_before = s, v_before = velocity, s_ahead(s.size()), v_ahead(mass.size()), s_next(s.size()),
        v_next(mass.size());
  double momentum = 1.0;
  ConeProjectionResult result;
  for (;; ++result.iterations) {
    if (result.iterations % iterations_between_checks == 0 || result.iterations == settings.max_iterations) {
      apply_transpose(velocity, strain);
      result.gap = duality_gap(balls, s, strain);
      result.converged = result.gap <= settings.gap_tolerance;
      if (result.converged || result.iterations >= settings.max_iterations) break;
    }
    const double momentum_next = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * momentum * momentum));
    const double beta = (momentum - 1.0) / momentum_next;
    s_ahead = s + beta * (s - s_before);
    v_ahead = velocity + beta * (velocity - v_before);
    apply_transpose(v_ahead, strain);
    for (;;) {
      s_next = s_ahead;
      balls.for_each([&](Eigen::Index block, Eigen::Index offset, int size) {
        s_next.segment(offset, size) -= strain.segment(offset, size) / (lipschitz * balls.curvature[block]);
      });
      project_onto_balls(balls, s_next);
      velocity_of(s_next, v_next);
      const double taken = (mass * (v_next - v_ahead).square()).sum();
      const double allowed = lipschitz * scaled_norm(s_next - s_ahead);
      // A step down at round-off says nothing about L; and a value that is not finite must not be waited for.
      const double noise = roundoff * (mass * v_ahead.square()).sum();
      if (!(taken > allowed * (1.0 + 1e-9) + noise)) break;
      lipschitz = std::max(1.05 * taken / allowed, 1.2) * lipschitz;
    }
    const bool uphill = (strain * (s_next - s)).sum() > 0.0;
    momentum = uphill ? 1.0 : momentum_next;
    s_before.swap(s);
    v_before.swap(velocity);
    s.swap(s_next);
    velocity.swap(v_next);
    if (uphill) {
      s_before = s;
      v_before = velocity;
    }
  }
  return result;
}

}  // namespace talus
