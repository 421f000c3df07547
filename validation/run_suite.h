// Which runs a suite consists of, which of them are there, and the making of those that are not.
//
// A run is there when OUT/runs/CASE/POINT/CODE_seedSEED/record.json is of the same inputs and the same version of the program, or, for
// the discrete codes of a point with stored = true, when the committed ensemble holds such a record. A folder is whole: while a run is
// being made its name ends in ".partial".
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "dem_cases/planned_run.h"
#include "validation/suites/suite.h"

namespace talus::validation {

/// Runs of a suite that failed or were interrupted.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One run of a suite and where it lies.
struct SuiteRun {
  std::string point;  // "column_collapse/a_1"
  dem::PlannedRun run;
  std::filesystem::path folder;
  double memory;  // MB, roughly
  bool stored;    // may come from the committed ensemble

  /// "column_collapse/a_1/liggghts/1"
  std::string name() const { return point + "/" + run.code + "/" + std::to_string(run.seed); }
};

/// All runs of a suite, with programs found and preflights passed; nothing is written. `defects`: of the continuum, for the
/// mutation check. Throws InputError.
std::vector<SuiteRun> plan_runs(const Suite& suite, const std::filesystem::path& output,
                                const Defects& defects = {});

/// Of the runs, those whose name is one of `only` or begins with one of them and a '/'. Throws InputError for one that selects none.
std::vector<SuiteRun> selected(const std::vector<SuiteRun>& runs, const std::vector<std::string>& only);

/// The run's identity: the hash of its inputs, its command and what measures it.
std::string input_hash_of(const SuiteRun& run);

struct FoundRecord {
  nlohmann::json record;
  std::string origin;  // "run" or "ensemble"
};

/// The record of a run that is there. Throws InputError.
std::optional<FoundRecord> find_record(const SuiteRun& run);

/// "stored", "missing", or "stale": there, but of other inputs or of another version.
std::string state_of(const SuiteRun& run);

struct MakingOptions {
  int workers;
  bool force = false;  // make also what is there
  std::function<bool()> stop = [] { return false; };
};

/// Makes what is missing, longest first, one core each. Every run is tried even when another fails. Returns the number of runs
/// that were made. Throws RunError with the number of failures, or "interrupted" when `stop` became true.
int make_runs(const std::vector<SuiteRun>& runs, const MakingOptions& options);

}  // namespace talus::validation
