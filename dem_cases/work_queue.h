// Runs independent jobs side by side, one core each, with progress shown.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace talus::dem {

struct QueuedJob {
  std::string label;                 // "yade seed 2"
  double expected_cpu;               // s
  std::function<void()> run;         // throws when the job fails
  std::function<double()> progress;  // fraction in [0, 1] that is done; called from another thread
};

/// Longest first, `workers` at a time. Every job is tried even when another fails; none is started once `stop` is true. Tells
/// what finished and what failed, and every few seconds how far it is, with the time left. Returns the number of
/// jobs that failed.
int run_side_by_side(const std::vector<QueuedJob>& jobs, int workers, const std::function<bool()>& stop);

}  // namespace talus::dem
