// Pressure and friction stress together, by alternating two convex projections (figure 5.7, step 3).
//
// The consistent scheme of method.md, section 3: faces weigh what the particles on them weigh, the packing constraint is
// on velocity, friction lives in the true cone, walls are bounded by their normal stress and reaction.
//
// Where this differs from method.md:
// - a face's mass is bounded below (smallest_face_fill) but not above: an overfull face keeps its inertia;
// - face velocities are not extrapolated into empty cells; the kernel keeps off them instead (particles/transfer.h);
// - only the first step counts as cold; a sudden change of contact later on gets the iterations of a warm step, and
//   there is no coarse (FAS) descent. A solve that this leaves unconverged is counted as a cap hit.
#pragma once

#include "continuum/particles/transfer.h"
#include "continuum/qp/cone_projection.h"
#include "continuum/qp/mprgp.h"

namespace talus {

/// Least fill that a face's mass is computed with; below it faces would move freely at the slightest stress.
inline constexpr double smallest_face_fill = 0.1;
/// Fill above which a cell counts as packed. With none, deposition noise opens holes (method.md, section 3).
inline constexpr double packed_fill = 0.9;

/// The stress on an active region, as impulses p dt h^2 (N s); the warm start of the next step.
struct Stress {
  Field pressure;         // cells + 1
  Eigen::ArrayXd copies;  // as FrictionOperator has them
};

struct ProjectionSettings {
  int iterations = 2;       // N, of a warm step
  int cold_iterations = 6;  // of the first step
  double tolerance = 0.01;  // of both solves, in units of g dt
  int max_pressure_iterations = 2000;
  int max_friction_iterations = 2000;
};

struct ProjectionReport {
  int pressure_iterations = 0;
  int friction_iterations = 0;
  int cap_hits = 0;                // solves that stopped at their cap, unconverged
  double pressure_residual = 0.0;  // m/s, of the last solve
  double friction_residual = 0.0;  // m/s, sqrt(gap / mass) of the last solve
};

/// From v* (GridState::velocity with gravity added) to v~ on all faces, in place. `velocity_scale` is g dt,
/// m/s.
ProjectionReport project(const ActiveRegion& region, const GridState& state, double dt, double velocity_scale,
                         bool cold, const ProjectionSettings& settings, double& lipschitz, Stress& stress,
                         Field& velocity);

/// Carries the stress from one region to the next: cells and wall faces keep their values, new ones start
/// from zero, impulses scale with the time step.
Stress carry_over(const ActiveRegion& from, const Stress& stress, const ActiveRegion& to, double dt_ratio);
Stress zero_stress(const ActiveRegion& region);

}  // namespace talus
