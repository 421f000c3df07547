// The mutation check: does the truth gate find out solvers that are broken on purpose (mutants.h)?
#pragma once

#include "validation/run_suite.h"

namespace talus::validation {

/// Runs the continuum of the suite with each of its mutants, in OUTPUT/mutants/NAME, and judges it. `results`: of the suite itself, judged;
/// its uncertainties are the mutants' as well. A mutant is found out where a row that is not FAIL without it has
/// |deviation| > band + U with it. So it is where its sand is not where
/// the case allows it: at the far wall, or out of the domain. A run that ends in another error, or does not converge, finds out nothing: points
/// without another are listed as not judged. Returns "mutants" of results.json:
/// [{"name", "title", "killed", "runs", "rows": [{"name", "observable", "deviation", "before", "verdict"}],
///   "by": [{"name", "observable", "verdict"}], "not_judged": [{"name", "why"}]}]. Throws InputError for a suite without mutants, RunError when interrupted.
nlohmann::json try_mutants(const Suite& suite, const nlohmann::json& results,
                           const std::filesystem::path& output, const MakingOptions& options);

/// Judges a mutant's continuum runs at one point ("points" of results.json) by their records; adds to its "rows", "by" and "not_judged".
void judge_mutant(const nlohmann::json& point, const std::vector<nlohmann::json>& records,
                  nlohmann::json& mutant);

/// A line a mutant, and how many survived.
std::string mutants_text(const nlohmann::json& mutants);

}  // namespace talus::validation
