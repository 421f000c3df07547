// Which runs the reference ensemble consists of.
#pragma once

#include <filesystem>
#include <vector>

#include "dem_cases/case.h"
#include "dem_cases/planned_run.h"

namespace talus::dem {

/// The case files that come with Talus and that read_case() reads.
std::vector<std::filesystem::path> gravity_case_files();

/// What decides how a case is measured, whichever code ran it (PlannedRun::measurement).
nlohmann::json measurement_of(const Case& a_case);

/// One run of a gravity-driven case by "liggghts" or "yade". Throws InputError when the code is not installed or the case fails its
/// preflight.
PlannedRun planned_run(const Case& a_case, const std::string& code, std::uint64_t seed);

/// The runs of one parameter point of a gravity-driven case: its reference seeds through both codes. Unlike planned_run()'s, they fail when
/// the deposit is not at rest at the end. Throws InputError
/// when a code is not installed or the case fails its preflight.
std::vector<PlannedRun> planned_runs(const Case& a_case);

/// That of the slots.
std::filesystem::path slot_case_file();

/// The shear cell's case file, which is of another kind.
std::filesystem::path shear_cell_file();

/// The runs of all points of a case file of either sort. Throws InputError.
std::vector<PlannedRun> planned_runs_of_file(const std::filesystem::path& file);

/// Every run of the ensemble.
std::vector<PlannedRun> all_planned_runs();

}  // namespace talus::dem
