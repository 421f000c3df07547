// Pressure and friction stress together, by alternating two convex projections (figure 5.7, step 3).
//
// The consistent scheme of method.md, section 3: faces weigh what the particles on them weigh, the packing constraint is
// on velocity, friction lives in the true cone, walls are bounded by their normal stress and reaction.
//
// Where this differs from method.md:
// - a face's mass is bounded below (smallest_face_fill) but not above: an overfull face keeps its inertia;
// - face velocities are not extrapolated into empty cells; the kernel keeps off them instead (particles/transfer.h);
// - a cell below its packing limit beside packed ones has friction by half of their pressure: the skin (friction.h);
// - solids that cut cells have no wall face of their own: the sand's whole momentum is on faces that the pressure moves,
//   so R is 0 there; what the grid lets through is stopped, with its friction, at the particle (particles/collide.h);
// - the first step, and the one after a gate opens or the domain was empty, count as cold; there is no coarse (FAS) descent. A solve that
//   this leaves unconverged is counted as a cap hit.
#pragma once

#include "continuum/particles/transfer.h"
#include "continuum/phases.h"
#include "continuum/qp/problem.h"
#include "continuum/stress/friction_solver.h"

namespace talus {

/// Least fill that a face's mass is computed with; below it faces would move freely at the slightest stress.
inline constexpr double smallest_face_fill = 0.1;

/// The stress on an active region, as impulses p dt h^2 (N s); the warm start of the next step.
struct Stress {
  Field pressure;         // cells + 1
  Eigen::ArrayXd copies;  // as FrictionOperator has them
};

struct ProjectionSettings {
  int iterations = 2;       // N, of a warm step
  int cold_iterations = 6;  // of the first step, and after a gate opened
  double tolerance = 0.01;  // of both solves, in units of g dt
  // Of friction alone, in units of what pressure changes velocities by (rms, by mass), where that is more: after an explosion.
  double relative_tolerance = 1e-3;
  int max_pressure_iterations = 2000;
  int max_friction_iterations = 2000;
  bool pressure_pulls = false;  // a deliberate defect, for the mutation check of the harness only
  ProblemRecorder record;       // unless empty, is given each problem before it is solved
};

struct ProjectionReport {
  int pressure_iterations = 0;
  int friction_iterations = 0;
  int cap_hits = 0;                // solves that stopped at their cap, unconverged
  double pressure_residual = 0.0;  // m/s, of the last solve
  double friction_residual = 0.0;  // m/s, sqrt(gap / mass) of the last solve
  PhaseSeconds seconds;            // of friction and pressure; the rest is the caller's to measure

  /// Adds what another projection cost; residuals are those of the later one.
  ProjectionReport& operator+=(const ProjectionReport& later);
};

/// From v* (GridState::velocity with gravity added) to v~ on all faces, in place. `velocity_scale` is g dt,
/// m/s.
ProjectionReport project(const ActiveRegion& region, const GridState& state, double dt, double velocity_scale,
                         bool cold, const ProjectionSettings& settings, FrictionSolver& solver,
                         Stress& stress, Field& velocity);
/// The same with bodies, whose `speeds` (BodyCoupling::speeds) enter with all other forces' impulses and leave with the
/// sand's.
ProjectionReport project(const ActiveRegion& region, const GridState& state, double dt, double velocity_scale,
                         bool cold, const ProjectionSettings& settings, FrictionSolver& solver,
                         const BodyCoupling& bodies, Stress& stress, Field& velocity, Field& speeds);

/// Carries the stress from one region to the next: cells, wall faces and contacts keep their values, new ones start
/// from zero, impulses scale with the time step.
Stress carry_over(const ActiveRegion& from, const Stress& stress, const ActiveRegion& to, double dt_ratio);
Stress zero_stress(const ActiveRegion& region);
/// The part of that for the tractions at contacts with solids, values_per_contact each, in the order of the contacts.
void carry_over_contacts(const ActiveRegion& from, const Eigen::Ref<const Field>& before,
                         const ActiveRegion& to, double dt_ratio, Eigen::Ref<Field> now);

}  // namespace talus
