// Runs a suite's jobs, one core each, side by side, with progress shown.
#pragma once

#include <functional>

#include "validation/stored_run.h"

namespace talus::validation {

/// All runs of a suite, with programs found and preflights passed; nothing is written yet. Throws InputError.
std::vector<Job> plan_jobs(const Suite& suite, const std::filesystem::path& output);

/// Longest first, `workers` at a time. Every job is tried even when another fails. Throws RunError with all
/// failures, or "interrupted" when `stop` became true.
void run_jobs(const Suite& suite, const std::vector<Job>& jobs, int workers,
              const std::function<bool()>& stop);

}  // namespace talus::validation
