// The continuum solver as one more code that runs a case: a PlannedRun of the program `talus`.
#pragma once

#include "dem_cases/planned_run.h"
#include "validation/backends/continuum_scene.h"

namespace talus::validation {

/// The code's names: the runs that are judged, and those that tell how far their figures hang on cells and time steps.
inline constexpr const char* continuum_code = "continuum";
inline constexpr const char* coarse_code = "continuum_coarse";            // cells twice as large
inline constexpr const char* short_steps_code = "continuum_short_steps";  // half the time step

struct ContinuumRequest {
  dem::Case a_case;
  dem::MaterialConstants material;
  ContinuumResolution resolution;
  std::uint64_t seed;
  std::string code = continuum_code;
  Defects defects = {};
  double time_limit;  // s
};

/// What decides the solver's results (provenance.h, solver_line), as the program itself tells it. Throws InputError when it is not built.
const std::string& continuum_version();

/// The run's record holds, beside what dem::measure gives: among the observables "bulk_density" and, of cases that come to rest,
/// "support" (balances.h), "solver" (the budget's summary), "count" (particles at the end),
/// "time_step_s" (the longest), "thickness_m". Throws
/// InputError when the program is not built or the continuum cannot run the case.
dem::PlannedRun continuum_run(const ContinuumRequest& request);

}  // namespace talus::validation
