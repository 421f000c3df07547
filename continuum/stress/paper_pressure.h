// The packing constraint as the source solves it, by MPRGP on the matrix-free operator: the problem of pressure.h. The
// paper scheme keeps it, since its record (tests/continuum/physics/README.md) was measured with it, and depends on which of the
// pressures within the tolerance is found.
#pragma once

#include "continuum/grid/operators.h"
#include "continuum/qp/mprgp.h"
#include "continuum/qp/problem.h"
#include "continuum/stress/body_coupling.h"

namespace talus {

/// As PressureSolver::solve.
BoundQpResult solve_pressure_by_mprgp(const ActiveRegion& region, const Field& inverse_mass,
                                      const Field& free_velocity, const Field& room,
                                      const BoundQpSettings& settings, Field& pressure,
                                      const ProblemRecorder& record = {}, const char* name = "pressure",
                                      const BodyCoupling& bodies = no_bodies(),
                                      const Field& free_speeds = {});

}  // namespace talus
