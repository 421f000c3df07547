// The benchmark of recorded problems runs: one line a problem, and errors are told.
#include <gmock/gmock.h>

#include "continuum/qp/problem_file.h"
#include "tests/continuum/qp/collapse_problems.h"
#include "tests/program.h"

namespace talus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string bench = TALUS_BINARY_DIR "/tests/qp_replay_bench";

TEST(QpReplayBench, ReportsTimeAndIterationsOfEveryProblem) {
  const testing::TestFolder folder;
  const auto moment = testing::collapse_moment({4, 1, 4}, 2);
  const ProblemRecorder record = record_step(folder.path(), 0, "test");
  record(testing::pressure_problem(moment, moment.velocity));
  record(testing::friction_problem(moment));
  const auto result =
      testing::run_program({bench, "--benchmark_min_time=0.001", folder.path().string()}, 60.0);
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, AllOf(HasSubstr("00_pressure.h5"), HasSubstr("01_friction.h5"),
                                   HasSubstr("iterations="), HasSubstr("unknowns=")));
}

TEST(QpReplayBench, SaysWhatItCannotRead) {
  const testing::TestFolder folder;
  const auto empty = testing::run_program({bench, folder.path().string()}, 60.0);
  EXPECT_EQ(empty.exit_code, 2);
  EXPECT_THAT(empty.output, HasSubstr("holds no .h5 files"));
  EXPECT_EQ(testing::run_program({bench}, 60.0).exit_code, 2);
}

}  // namespace
}  // namespace talus
