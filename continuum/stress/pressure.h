// The packing constraint: pressure is what keeps the sand from becoming denser than its limit, and never pulls.
//
//   find P >= 0 complementary to  share * room + h div v >= 0,   v = v_0 - M^-1 D1 P,   per cell: (5.13) in velocity form,
//   minimise 1/2 P'A P + b'P over P >= 0,   A = D1^T M^-1 D1,   b = share * room - D1^T v_0
//
// and with bodies (body_coupling.h) A gains U U', b the compression by their free speeds.
//
// `room` is how much a cell may still be compressed, as a velocity: slack h / dt; share is what solids leave open of it.
// How it is solved: nonnegative_solve.h.
#pragma once

#include "continuum/qp/problem.h"
#include "continuum/stress/nonnegative_solve.h"

namespace talus {

/// Solves for the pressure on one region with one set of masses, as often as these stand: what depends on nothing else is
/// made once.
class PressureSolver {
 public:
  /// `inverse_mass` has open_faces + 1 entries; all arguments must outlive the solver.
  PressureSolver(const ActiveRegion& region, const Field& inverse_mass,
                 const BodyCoupling& bodies = no_bodies());
  PressureSolver(const PressureSolver&) = delete;  // parts refer to each other
  PressureSolver& operator=(const PressureSolver&) = delete;

  /// `free_velocity` has open_faces + 1 entries, `room` cells + 1. `pressure` (cells + 1) enters as the warm start and
  /// leaves as P, N s; all zero, it is no start, and nested iteration finds one. The tolerance of `settings` is a velocity,
  /// m/s. `record`, unless empty, is given the problem under `name`.
  BoundQpResult solve(const Field& free_velocity, const Field& room, const BoundQpSettings& settings,
                      Field& pressure, const ProblemRecorder& record = {}, const char* name = "pressure");
  /// The same with the bodies' free speeds (BodyCoupling::speeds).
  BoundQpResult solve(const Field& free_velocity, const Field& free_speeds, const Field& room,
                      const BoundQpSettings& settings, Field& pressure, const ProblemRecorder& record = {},
                      const char* name = "pressure");

  /// A deliberate defect (ProjectionSettings::pressure_pulls): the pressure of an incompressible liquid, h div v = 0 with P of
  /// either sign, by plain MPRGP. `room` goes with the bound: without P >= 0 it would be a demand, not a limit, and loose sand
  /// sucks itself in (a column imploded after 0.11 s). Should the energy have no minimum, it is told as not converged.
  BoundQpResult solve_pulling(const Field& free_velocity, const Field& free_speeds,
                              const BoundQpSettings& settings, Field& pressure,
                              const ProblemRecorder& record = {});

 private:
  BoundQp problem(const char* name, const Field& linear, const Field& start,
                  const BoundQpSettings& settings) const;

  const ActiveRegion& region_;
  const Field& inverse_mass_;
  const BodyCoupling& bodies_;
  CellLevels cells_;
  CellLaplacian laplacian_;
  Multigrid multigrid_;
  NonnegativeSolve work_;
  Field transposed_, linear_;  // scratch
};

/// A single solve.
BoundQpResult solve_pressure(const ActiveRegion& region, const Field& inverse_mass,
                             const Field& free_velocity, const Field& room, const BoundQpSettings& settings,
                             Field& pressure, const ProblemRecorder& record = {},
                             const char* name = "pressure");

}  // namespace talus
