#include "validation/run_suite.h"

#include <fmt/format.h>

#include "dem_cases/work_queue.h"

namespace talus::validation {
std::vector<Job> plan_jobs(const Suite& suite, const std::filesystem::path& output) {
  std::vector<Job> jobs;
  for (std::size_t c = 0; c < suite.cases.size(); ++c) {
    const SuiteCase& entry = suite.cases[c];
    for (const auto& backend : entry.backends) {
      for (const auto seed : entry.seeds) {
        const RunRequest request{entry.column, entry.material, suite.resolution, seed};
        jobs.push_back({c, backend, seed, entry.time_limit, entry.expected_cpu.at(backend),
                        run_folder(output, entry.column.name, backend, seed),
                        make_backend(backend, request)});
      }
    }
  }
  return jobs;
}

void run_jobs(const Suite& suite, const std::vector<Job>& jobs, int workers,
              const std::function<bool()>& stop) {
  std::vector<dem::QueuedJob> queue;
  for (const Job& job : jobs) {
    queue.push_back({.label = job.label(),
                     .expected_cpu = job.expected_cpu,
                     .run = [&] { run_job(suite.cases[job.case_index].column, job, stop); },
                     .progress = [&] { return job.backend.progress(job.partial_folder()); }});
  }
  const int failures = dem::run_side_by_side(queue, workers, stop);
  if (stop()) throw RunError("interrupted; finished runs are kept, no results were written");
  if (failures > 0) {
    throw RunError(
        fmt::format("{} of {} runs failed, as told above; no results were written", failures, jobs.size()));
  }
}

}  // namespace talus::validation
