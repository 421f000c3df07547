// The drift gate: has anything moved since the last accepted results? It knows nothing of the discrete codes: a change for the better
// drifts as much as one for the worse. (Whether we are right is the truth gate's: truth.h.)
//
//   change = continuum mean now / accepted mean - 1
//   FAIL          |change| > tolerance
//   INCONCLUSIVE  a value is missing, not finite, or not in the baseline; or a run did not converge
//
// The solver repeats itself to the last bit on one machine, and rounds differently on another; a collapse is chaotic, so rounding may grow to
// what another seed of the particle lattice would do, and no further. The means of two such sets of n seeds differ by s sqrt(2 / n); hence tolerance
// = 2 s sqrt(2 / n) over the accepted mean, s being the deviation of the accepted seeds, and never below smallest_tolerance.
//
// It looks at what the case is compared by, and at the time when the flow stopped.
//
// Baselines are validation/baseline/SUITE.json, written by accept() alone; history.jsonl beside them has a line for each acceptance.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "validation/gates/verdict.h"

namespace talus::validation {

/// Relative; of accepted values that happen to lie close together.
inline constexpr double smallest_tolerance = 1e-3;

/// The folder of the baselines that come with Talus.
std::filesystem::path baseline_folder();

/// The accepted baseline of a suite, or nothing when none was ever accepted. Throws InputError for one that is damaged.
std::optional<nlohmann::json> read_baseline(const std::filesystem::path& folder, const std::string& suite);

struct DriftJudgement {
  nlohmann::json rows;  // "drift" of a point in results.json
  Verdict verdict;
};

/// `point` of results.json against the baseline.
DriftJudgement judge_drift(const nlohmann::json& point, const nlohmann::json& baseline);

/// Sets "drift" of the results and of all their points. A suite without a baseline is inconclusive, and so is one whose baseline holds
/// points that the results lack.
void judge_drift_of_suite(nlohmann::json& results, const std::filesystem::path& folder);

/// Makes these results the baseline of their suite and adds {when, who, why, git_hash, suite, changes} to the history. Results of a part of
/// the suite (a tag) move their own points only. Returns the entry. Throws InputError for an empty reason, incomplete results, runs that did not
/// converge, or values that are not finite.
nlohmann::json accept(const nlohmann::json& results, const std::string& reason,
                      const std::filesystem::path& folder);

/// All acceptances of a suite, oldest first. Throws InputError for a damaged history.
nlohmann::json read_history(const std::filesystem::path& folder, const std::string& suite);

}  // namespace talus::validation
