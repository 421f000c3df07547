// The packing constraint: pressure is what keeps the sand from becoming denser than its limit, and never pulls.
//
//   find P >= 0 complementary to  share * room + h div v >= 0,   v = v_0 - M^-1 D1 P,   per cell: (5.13) in velocity form,
//   minimise 1/2 P'A P + b'P over P >= 0,   A = D1^T M^-1 D1,   b = share * room - D1^T v_0
//
// `room` is how much a cell may still be compressed, as a velocity: slack h / dt; share is what solids leave open of it.
#pragma once

#include "continuum/grid/operators.h"
#include "continuum/qp/mprgp.h"
#include "continuum/qp/problem.h"

namespace talus {

/// `inverse_mass` and `free_velocity` have open_faces + 1 entries. `pressure` (cells + 1) enters as the warm
/// start and leaves as P, N s. The tolerance of `settings` is a velocity, m/s. `record`, unless empty, is given the problem
/// under `name`.
BoundQpResult solve_pressure(const ActiveRegion& region, const Field& inverse_mass,
                             const Field& free_velocity, const Field& room, const BoundQpSettings& settings,
                             Field& pressure, const ProblemRecorder& record = {},
                             const char* name = "pressure");

}  // namespace talus
