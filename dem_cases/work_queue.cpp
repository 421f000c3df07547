#include "dem_cases/work_queue.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <numeric>
#include <thread>

namespace talus::dem {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds progress_interval{5};

enum class Phase { waiting, running, ended };

/// What the workers share.
struct Board {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<Phase> phases;
  int failures = 0;
  std::size_t next = 0;  // in the order of the queue
  int busy = 0;
};

/// How much is done of the expected cost of all jobs, and what runs now.
std::string progress_line(const std::vector<QueuedJob>& jobs, const Board& board, double elapsed) {
  std::vector<std::string> parts;
  double done = 0.0, total = 0.0;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    double fraction = board.phases[i] == Phase::ended ? 1.0 : 0.0;
    if (board.phases[i] == Phase::running) {
      fraction = jobs[i].progress();
      parts.push_back(fmt::format("{} {:.0f} %", jobs[i].label, 100.0 * fraction));
    }
    done += fraction * jobs[i].expected_cpu;
    total += jobs[i].expected_cpu;
  }
  const double share = done / total;
  constexpr double enough_to_tell = 0.02;
  const std::string left =
      share > enough_to_tell ? fmt::format(", {:.0f} s left", elapsed * (1.0 / share - 1.0)) : std::string();
  return fmt::format("{:3.0f} % done{}: {}", 100.0 * share, left, fmt::join(parts, ", "));
}

}  // namespace

int run_side_by_side(const std::vector<QueuedJob>& jobs, int workers, const std::function<bool()>& stop) {
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
        jobs[i].run();
      } catch (const std::exception& error) {
        failure = error.what();
      }
      lock.lock();
      board.phases[i] = Phase::ended;
      if (failure.empty()) {
        spdlog::info("{} finished", jobs[i].label);
      } else {
        spdlog::error("{}", failure);
        ++board.failures;
      }
    }
    --board.busy;
    board.changed.notify_all();
  };
  std::vector<std::jthread> threads;
  for (int w = 0; w < workers; ++w) threads.emplace_back(work);
  const auto start = Clock::now();
  std::unique_lock lock(board.mutex);
  while (!board.changed.wait_for(lock, progress_interval, [&] { return board.busy == 0; })) {
    spdlog::info(progress_line(jobs, board, std::chrono::duration<double>(Clock::now() - start).count()));
  }
  return board.failures;
}

}  // namespace talus::dem
