// The scheme of the source, to the letter, as its record and the yardstick for ours (method.md, section 3).
//
//   flux u = phi v on faces;  u~ = phi v* + M^-1 (D2 S - D1 P),  M^-1 = (phi/rho) / (h^3 k)
//   packing  0 <= P complementary to  (1 - phi) h/dt + h div u~ >= 0                    (5.13), (5.47-5.48)
//   friction in the box |s_ij| <= alpha p, one component at a time (paper_friction.h)   (5.44), (5.49-5.50)
//   alternately friction and pressure, `iterations` times, on a cold step as on a warm one; warm-started
//
// k is what solids leave open of the face's kernel: 1 away from them. phi is the fill as deposited, and never above 1: the density correction of figure 5.7, step 2 works on rho itself, so
// what ours, which moves particles instead, leaves above 1 counts as 1. (Pushed apart within one step, it raised the energy
// of a column collapse by up to 1.2 % of the start in a step; now by 0.01 %.) phi/rho of a face is its deposited volume over
// its mass.
//
// The particles need v~ = u~ / phi. Where a face is nearly empty that is without bound, so it is taken as
//   v~ = v* + (u~ - phi v*) / max(phi, smallest_face_fill)
// which is the same above the floor, and leaves sand in free flight alone below it. Grains may leave a wall, not enter it.
//
// What is known to be wrong with it is recorded in tests/continuum/physics/paper_scheme_test.cpp.
#pragma once

#include "continuum/stress/staggered_projections.h"

namespace talus {

/// As impulses p dt h^2 (N s); the warm start of the next step.
struct PaperStress {
  Field pressure;  // cells + 1
  StressField friction;
};

/// From v* to v~ on all faces, in place, as `project` of the consistent scheme; both residuals are the largest component of
/// a projected gradient, m/s, and each component step that stops at its cap counts as a hit. `up` is the axis of the
/// source's y (up_axis). Pressure pushes bodies within its solve; friction is solved against bodies as they move then, and
/// what it does to them is added after.
ProjectionReport project(const ActiveRegion& region, const GridState& state, double dt, double velocity_scale,
                         int up, const ProjectionSettings& settings, const BodyCoupling& bodies,
                         PaperStress& stress, Field& velocity, Field& speeds);

PaperStress zero_paper_stress(const ActiveRegion& region);
/// Cells and edges keep their values, new ones start from zero, impulses scale with the time step.
PaperStress carry_over(const ActiveRegion& from, const PaperStress& stress, const ActiveRegion& to,
                       double dt_ratio);

}  // namespace talus
