// Makes one planned run of a discrete code and reduces it to a record.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "dem_cases/planned_run.h"

namespace talus::dem {

/// The run itself failed: crash, time limit, leak. The message says which run, why, and where its folder is.
class RunFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Where a run is made, below `runs`.
std::filesystem::path run_folder(const std::filesystem::path& runs, const PlannedRun& run);

/// Writes the run's input into a fresh folder and returns its hash, the run's identity. Throws InputError, also for
/// an input that the code's preflight refuses.
std::string prepare_run(const PlannedRun& run, const std::filesystem::path& folder);

/// The stored record of this very run: its input is written into a folder that is gone afterwards, to know its hash. Throws
/// InputError.
std::optional<nlohmann::json> current_record(const std::filesystem::path& reference, const PlannedRun& run);

/// Runs what prepare_run() has written to its end and measures it:
///   {"case", "point", "code", "seed", "version", "command", "input_hash", "cpu_s", "wall_s", "observables", "curves",
///    "made_by": provenance}, numbers of the measurement to six digits.
/// Throws RunFailed, also when `stop` ended it; its folder then stays for a look.
nlohmann::json make_run(const PlannedRun& run, const std::filesystem::path& folder,
                        const std::string& input_hash, const std::function<bool()>& stop);

}  // namespace talus::dem
