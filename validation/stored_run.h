// A finished run in its folder: the input that made it, the neutral snapshots, and record.json with what was
// measured.
//
// A run lives under a ".partial" name until all of it is there; a folder without that suffix is a whole run.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "validation/backends/backend.h"

namespace talus::validation {

/// The run itself failed: crash, time limit, leak. The message says which run, why, and where its folder is.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One run to be made.
struct Job {
  std::size_t case_index;  // in the suite
  std::string backend_name;
  std::uint64_t seed;
  double time_limit;    // s
  double expected_cpu;  // s
  std::filesystem::path folder;
  Backend backend;

  std::string label() const;  // "yade seed 2"
  std::filesystem::path partial_folder() const;
};

/// Runs a job to its end, measures it, and puts its folder in place. Throws RunError, also when `stop` ended
/// it.
void run_job(const dem::Case& column, const Job& job, const std::function<bool()>& stop);

/// The record of a finished run, as results.json holds it. Throws InputError when the folder holds no whole
/// run.
nlohmann::json read_record(const std::filesystem::path& folder);

/// The last snapshot of a finished run, ready for the report: {backend, seed, time, x, z, radius, x0}. `record`: as
/// read_record gives it; `layers`: the continuum's particles across its thickness. Throws SnapshotError.
nlohmann::json picture_of_run(const nlohmann::json& record, const std::filesystem::path& folder, int layers);

/// Where a finished run of a suite lies.
std::filesystem::path run_folder(const std::filesystem::path& output, const std::string& case_name,
                                 const std::string& backend, std::uint64_t seed);

}  // namespace talus::validation
