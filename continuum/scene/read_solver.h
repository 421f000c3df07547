// The [solver] table of a scene: scheme, tolerances, caps, time step, and the deliberate defects of the mutation check.
#pragma once

#include <string>

#include "continuum/files/checked_table.h"
#include "continuum/step.h"

namespace talus {

/// Reads the keys of [solver] into `settings`; what is not there stays as it is. `courant_factor` scales the longest step.
///
/// `broken` breaks the consistent scheme on purpose. The harness runs such solvers to see that its truth gate would notice;
/// nothing else should. Returns its value, empty for a sound solver:
///   "pressure_pulls"         the pressure may be negative, as in a liquid: sand can neither be packed nor fall apart
///                            (PressureSolver::solve_pulling)
///   "no_density_correction"  step 1 of figure 5.7 is left out: sand that advection packs above its limit stays so
/// Throws InputError.
std::string read_solver(const CheckedTable& solver, StepSettings& settings);

}  // namespace talus
