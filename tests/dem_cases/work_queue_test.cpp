#include "dem_cases/work_queue.h"

#include <gmock/gmock.h>

#include <atomic>
#include <mutex>
#include <stdexcept>

namespace talus::dem {
namespace {

using ::testing::ElementsAre;

QueuedJob job(double cost, std::function<void()> run) {
  return {.label = "job", .expected_cpu = cost, .run = std::move(run), .progress = [] { return 0.5; }};
}

TEST(WorkQueue, StartsTheLongestFirst) {
  std::vector<int> order;
  const auto note = [&](int i) { return [&, i] { order.push_back(i); }; };
  EXPECT_EQ(run_side_by_side({job(1, note(1)), job(3, note(3)), job(2, note(2))}, 1, [] { return false; }),
            0);
  EXPECT_THAT(order, ElementsAre(3, 2, 1));
}

TEST(WorkQueue, AFailureDoesNotStopTheOthers) {
  std::atomic<int> done = 0;
  const auto fail = [] { throw std::runtime_error("no"); };
  const auto work = [&] { ++done; };
  EXPECT_EQ(run_side_by_side({job(3, fail), job(2, work), job(1, work)}, 2, [] { return false; }), 1);
  EXPECT_EQ(done, 2);
}

TEST(WorkQueue, NothingIsStartedAfterAStop) {
  std::atomic<int> done = 0;
  std::atomic<bool> stop = false;
  const auto work = [&] {
    ++done;
    stop = true;
  };
  run_side_by_side({job(3, work), job(2, work), job(1, work)}, 1, [&] { return stop.load(); });
  EXPECT_EQ(done, 1);
}

}  // namespace
}  // namespace talus::dem
