// The truth gate: does the continuum agree with the discrete codes? (The drift gate, against our own last
// accepted results, is another thing.)
//
//   deviation = (continuum mean - reference mean) / reference mean    reference: all runs of the discrete codes
//   u         = 2 s / sqrt(n) / reference mean                        s, n: standard deviation, number of those runs
//
//   FAIL          |deviation| > band + u
//   PASS          |deviation| <= band, and u <= band
//   INCONCLUSIVE  otherwise, and whenever a run is missing, not finite, not at rest, or did not converge
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "dem_cases/case.h"

namespace talus::validation {

enum class Verdict { pass, inconclusive, fail };

/// "PASS", "INCONCLUSIVE", "FAIL".
std::string verdict_text(Verdict verdict);

/// The worse of two: FAIL over INCONCLUSIVE over PASS.
Verdict worse(Verdict a, Verdict b);

struct TruthJudgement {
  nlohmann::json summary;  // one entry per observable, as results.json has them
  Verdict verdict;
};

/// `runs` as in results.json: backend, seed, status, observables, solver.
TruthJudgement judge_truth(std::span<const dem::ObservableBand> bands, const nlohmann::json& runs);

}  // namespace talus::validation
