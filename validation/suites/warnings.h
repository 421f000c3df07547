// What is dangerous about a suite, told before anything runs.
#pragma once

#include <string>
#include <vector>

#include "validation/run_suite.h"

namespace talus::validation {

inline constexpr int least_cells_in_opening =
    6;  // across narrower ones too little sand flows (talus check says so too)

/// A line each: what dem::case_warnings tells of the points, openings that the continuum does not resolve, and runs that need more
/// memory than `memory`, bytes that are free.
std::vector<std::string> suite_warnings(const Suite& suite, const std::vector<SuiteRun>& runs, double memory);

}  // namespace talus::validation
