// results.json and report.html of a suite, from its finished runs.
#pragma once

#include "validation/run_suite.h"

namespace talus::validation {

inline constexpr const char* results_name = "results.json";
inline constexpr const char* report_name = "report.html";

/// The whole of results.json (schema "talus-results", version 1). Throws InputError when a run is missing.
nlohmann::json assemble_results(const Suite& suite, const std::vector<Job>& jobs,
                                const std::string& command_line);

/// Reads results.json back and checks that it is one of ours and complete. Throws InputError.
nlohmann::json read_results(const std::filesystem::path& folder);

/// Judges results by their own runs and bands, in place: the summary and verdict of each case, and of all.
void judge(nlohmann::json& results);

/// Pictures of the deposits, for the report, from the runs stored in `output`. Throws SnapshotError.
nlohmann::json make_pictures(const nlohmann::json& results, const std::filesystem::path& output);

/// A short table for the terminal: observables by code, deviation, band, verdict.
std::string summary_text(const nlohmann::json& results);

}  // namespace talus::validation
