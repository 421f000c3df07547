// results.json of a suite: every figure of every run, both gates' judgements, and what made them.
#pragma once

#include "validation/run_suite.h"

namespace talus::validation {

inline constexpr const char* results_name = "results.json";
inline constexpr const char* report_name = "report.html";

/// The whole of results.json (schema "talus-results", version 2). `runs`: all of the suite's. Throws InputError when one of them
/// is not there. Not judged yet.
nlohmann::json assemble_results(const Suite& suite, const std::vector<SuiteRun>& runs,
                                const std::string& command_line);

/// Reads results.json back and checks that it is one of ours and complete. Throws InputError.
nlohmann::json read_results(const std::filesystem::path& folder);

/// Judges results by their own runs and bands, in place: both gates, the metrics of the whole suite, the history. `baseline`: the folder
/// of accepted baselines.
void judge(nlohmann::json& results, const std::filesystem::path& baseline);

/// Why the results no longer are those of the suite, the cases, the calibration and the solver that they name; empty when they are.
std::string why_stale(const nlohmann::json& results);

}  // namespace talus::validation
