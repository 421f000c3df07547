#include "validation/run_suite.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <numeric>
#include <thread>

namespace talus::validation {
namespace {

constexpr std::chrono::seconds progress_interval{5};

enum class Phase { waiting, running, finished, failed };

/// What the workers share.
struct Board {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<Phase> phases;
  int failures = 0;
  std::size_t next = 0;  // in the order of the queue
  int busy = 0;
};

std::string progress_line(const std::vector<Job>& jobs, const Board& board) {
  std::vector<std::string> parts;
  double done = 0.0, total = 0.0;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    double fraction = board.phases[i] >= Phase::finished ? 1.0 : 0.0;
    if (board.phases[i] == Phase::running) {
      fraction = jobs[i].backend.progress(jobs[i].partial_folder());
      parts.push_back(fmt::format("{} {:.0f} %", jobs[i].label(), 100.0 * fraction));
    }
    done += fraction * jobs[i].expected_cpu;
    total += jobs[i].expected_cpu;
  }
  return fmt::format("{:3.0f} % of the suite: {}", 100.0 * done / total, fmt::join(parts, ", "));
}

}  // namespace

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
  std::vector<std::size_t> queue(jobs.size());
  std::iota(queue.begin(), queue.end(), std::size_t{0});
  std::stable_sort(queue.begin(), queue.end(),
                   [&](auto a, auto b) { return jobs[a].expected_cpu > jobs[b].expected_cpu; });
  Board board;
  board.phases.assign(jobs.size(), Phase::waiting);
  board.busy = workers;

  const auto work = [&] {
    std::unique_lock lock(board.mutex);
    while (board.next < queue.size() && !stop()) {
      const std::size_t i = queue[board.next++];
      board.phases[i] = Phase::running;
      lock.unlock();
      std::string failure;
      try {
        run_job(suite.cases[jobs[i].case_index].column, jobs[i], stop);
      } catch (const std::exception& error) {
        failure = error.what();
      }
      lock.lock();
      board.phases[i] = failure.empty() ? Phase::finished : Phase::failed;
      if (failure.empty()) {
        spdlog::info("{} finished", jobs[i].label());
      } else {
        spdlog::error("{}", failure);
        ++board.failures;
      }
    }
    --board.busy;
    board.changed.notify_all();
  };
  {
    std::vector<std::jthread> threads;
    for (int w = 0; w < workers; ++w) threads.emplace_back(work);
    std::unique_lock lock(board.mutex);
    while (!board.changed.wait_for(lock, progress_interval, [&] { return board.busy == 0; })) {
      spdlog::info(progress_line(jobs, board));
    }
  }
  if (stop()) throw RunError("interrupted; finished runs are kept, no results were written");
  if (board.failures > 0) {
    throw RunError(fmt::format("{} of {} runs failed, as told above; no results were written", board.failures,
                               jobs.size()));
  }
}

}  // namespace talus::validation
