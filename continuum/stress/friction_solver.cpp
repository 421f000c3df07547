#include "continuum/stress/friction_solver.h"

#include <limits>

namespace talus {
namespace {

constexpr int iterations_between_checks = 5;
constexpr double lipschitz_decay = 0.9;  // between calls, so that one hard step does not slow all later ones

/// Round-off in strains, summed over all copies, leaves a duality gap that no iteration goes below: in `epsilon` of the
/// velocity, and of what each copy's own stress does to it.
double gap_of_roundoff(const BallBlocks& balls, const Field& free_velocity, double epsilon) {
  const double fastest = free_velocity.abs().maxCoeff();
  return epsilon * (balls.radius * (balls.curvature * balls.radius + fastest)).sum();
}

/// Single precision where its round-off is small beside the gap asked for.
bool single_precision_suffices(const BallBlocks& balls, const Field& free_velocity, double gap_tolerance) {
  constexpr double share = 0.1;
  return gap_of_roundoff(balls, free_velocity, std::numeric_limits<float>::epsilon()) < share * gap_tolerance;
}

}  // namespace

void FrictionSolver::prepare(const ActiveRegion& region, const Field& inverse_mass,
                             const BodyCoupling& bodies) {
  bodies_ = &bodies;
  region_ = &region;
  inverse_mass_ = &inverse_mass;
  single_precision_.ready = double_precision_.ready = false;
}

ConeProjectionResult FrictionSolver::solve(const BallBlocks& balls, const Field& free_velocity,
                                           const ConeProjectionSettings& settings, Eigen::ArrayXd& copies) {
  return solve(balls, free_velocity, Field::Zero(bodies_->inverse_mass().size()), settings, copies);
}

ConeProjectionResult FrictionSolver::solve(const BallBlocks& balls, const Field& free_velocity,
                                           const Field& free_speeds, const ConeProjectionSettings& settings,
                                           Eigen::ArrayXd& copies) {
  // Once a solve of a step needs double precision, its later ones have it too.
  if (!double_precision_.ready && single_precision_suffices(balls, free_velocity, settings.gap_tolerance))
    return solve(single_precision_, double_precision_, balls, free_velocity, free_speeds, settings, copies);
  return solve(double_precision_, single_precision_, balls, free_velocity, free_speeds, settings, copies);
}

template <class Real, class Other>
ConeProjectionResult FrictionSolver::solve(Memory<Real>& memory, Memory<Other>& unused,
                                           const BallBlocks& balls, const Field& free_velocity,
                                           const Field& free_speeds, const ConeProjectionSettings& settings,
                                           Eigen::ArrayXd& copies) {
  constexpr double epsilon = std::numeric_limits<Real>::epsilon();
  constexpr double noise = 450.0 * epsilon * 450.0 * epsilon;  // of a squared velocity; sums have many terms
  constexpr double slack = std::max(1e-9, 100.0 * epsilon);
  FrictionRows<Real>& rows = memory.rows;
  if (!memory.ready) {
    unused = {};
    rows.prepare(*region_, *inverse_mass_, *bodies_, balls);
    for (auto* s : {&memory.now, &memory.before, &memory.next}) rows.reset(*s);
    for (auto* v : {&memory.velocity, &memory.velocity_before, &memory.velocity_next, &memory.velocity_ahead})
      rows.reset(*v);
    memory.ready = true;
  }
  lipschitz_ = std::max(smallest_lipschitz, lipschitz_decay * lipschitz_);
  rows.read(balls, free_velocity, free_speeds, copies, memory.now);
  rows.project(memory.now);
  rows.stress_of(memory.now);
  rows.move_faces(memory.velocity_ahead, memory.velocity);
  double momentum = 1.0;
  ConeProjectionResult result;
  for (;; ++result.iterations) {
    if (result.iterations % iterations_between_checks == 0 || result.iterations == settings.max_iterations) {
      rows.strain_of(memory.velocity);
      result.gap = rows.duality_gap(memory.now);
      result.converged = result.gap <= settings.gap_tolerance;
      if (result.converged || result.iterations >= settings.max_iterations) break;
    }
    const double momentum_next = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * momentum * momentum));
    const Real beta = static_cast<Real>((momentum - 1.0) / momentum_next);
    rows.extrapolate(memory.velocity, memory.velocity_before, beta, memory.velocity_ahead);
    rows.strain_of(memory.velocity_ahead);
    bool uphill = false;
    for (;;) {
      const PassSums step = rows.step(lipschitz_, beta, memory.now, memory.before, memory.next);
      uphill = step.first > 0.0;
      rows.stress_of(memory.next);
      const PassSums moved = rows.move_faces(memory.velocity_ahead, memory.velocity_next);
      const double allowed = lipschitz_ * step.second;
      // A step down at round-off says nothing about L; and a value that is not finite must not be waited for.
      if (!(moved.first > allowed * (1.0 + slack) + noise * moved.second)) break;
      lipschitz_ = std::max(1.05 * moved.first / allowed, 1.2) * lipschitz_;
    }
    momentum = uphill ? 1.0 : momentum_next;  // with 1 the next step starts from where it is
    std::swap(memory.before, memory.now);
    std::swap(memory.now, memory.next);
    std::swap(memory.velocity_before, memory.velocity);
    std::swap(memory.velocity, memory.velocity_next);
  }
  rows.write(memory.now, copies);
  return result;
}

}  // namespace talus
