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

/// Pictures of the deposits, for the report.
nlohmann::json make_pictures(const Suite& suite, const std::vector<Job>& jobs);

/// A short table for the terminal: observables by code, deviation, band, verdict.
std::string summary_text(const nlohmann::json& results);

}  // namespace talus::validation
