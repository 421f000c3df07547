// The runner, with programs of the system for backends: order, failures, stopping.
#include "validation/run_suite.h"

#include <gmock/gmock.h>

#include <atomic>

#include "tests/program.h"

namespace talus::validation {
namespace {

using ::testing::HasSubstr;

/// Jobs that run `commands`; each leaves a series of one grain that rolls and stops.
struct Bench {
  testing::TestFolder folder;
  Suite suite;
  std::vector<Job> jobs;

  explicit Bench(const std::vector<std::vector<std::string>>& commands) {
    SuiteCase entry;
    entry.column =
        dem::read_case(std::filesystem::path(TALUS_SOURCE_DIR) / "tests/dem_cases/data/tiny_column.toml");
    suite.cases.push_back(entry);
    for (std::size_t i = 0; i < commands.size(); ++i) {
      Backend backend;
      backend.version = "test";
      backend.command = commands[i];
      backend.log_file = "log";
      backend.thickness = 0.012;
      backend.write_input = [](const auto& where) { write_file_atomically(where / "input", "x"); };
      backend.progress = [](const auto&) { return 0.5; };
      backend.failure_text = [](const auto&) { return std::string("as it said"); };
      backend.solver_summary = [](const auto&) { return nlohmann::json(); };
      backend.read_output = [](const auto&) {
        analysis::SnapshotSeries series;
        for (int frame = 0; frame < 30; ++frame) {
          analysis::Snapshot s;
          s.time = 0.01 * frame;
          s.positions = analysis::Vectors::Constant(3, 1, 0.005);
          s.velocities = analysis::Vectors::Zero(3, 1);
          s.volumes = Eigen::VectorXd::Constant(1, 1e-8);
          series.push_back(s);
        }
        return series;
      };
      jobs.push_back(
          {0, "yade", i + 1, 20.0, 1.0, run_folder(folder.path(), "tiny_column", "yade", i + 1), backend});
    }
  }
  std::string error(
      int workers, const std::function<bool()>& stop = [] { return false; }) {
    try {
      run_jobs(suite, jobs, workers, stop);
    } catch (const RunError& failure) {
      return failure.what();
    }
    return "";
  }
};

TEST(RunJobs, RunsAllWithFewerOrMoreWorkersThanJobs) {
  for (const int workers : {1, 2, 9}) {
    Bench bench({{"/bin/true"}, {"/bin/true"}, {"/bin/true"}});
    EXPECT_EQ(bench.error(workers), "");
    for (const auto& job : bench.jobs) EXPECT_EQ(read_record(job.folder)["status"], "ok");
  }
}

TEST(RunJobs, TriesEveryJobEvenWhenAnotherFails) {
  Bench bench({{"/bin/false"}, {"/bin/true"}, {"/bin/sh", "-c", "kill -9 $$"}, {"/bin/true"}});
  EXPECT_THAT(bench.error(2), HasSubstr("2 of 4 runs failed"));
  EXPECT_FALSE(std::filesystem::exists(bench.jobs[0].folder));
  EXPECT_TRUE(std::filesystem::exists(bench.jobs[1].folder));
  EXPECT_FALSE(std::filesystem::exists(bench.jobs[2].folder));
  EXPECT_TRUE(std::filesystem::exists(bench.jobs[3].folder));
}

TEST(RunJobs, StopsBetweenAndDuringJobsAndKeepsWhatWasWholeBefore) {
  Bench bench({{"/bin/true"}, {"/bin/sleep", "60"}, {"/bin/true"}});
  std::filesystem::create_directories(bench.jobs[2].folder);
  write_file_atomically(bench.jobs[2].folder / "record.json", "{\"status\": \"earlier\"}");
  std::atomic<int> asked = 0;
  EXPECT_THAT(bench.error(1, [&] { return ++asked > 5; }), HasSubstr("interrupted"));
  EXPECT_TRUE(std::filesystem::exists(bench.jobs[0].folder));
  EXPECT_FALSE(std::filesystem::exists(bench.jobs[1].folder));
  EXPECT_EQ(read_record(bench.jobs[2].folder)["status"], "earlier");
}

TEST(RunJobs, ADepositAtTheFarWallOrWithALossIsNoResult) {
  const auto with = [](Bench& bench, auto change) {
    auto& read = bench.jobs[0].backend.read_output;
    read = [before = read, change](const auto& where) {
      auto series = before(where);
      change(series.back());
      return series;
    };
  };
  Bench far_wall({{"/bin/true"}});
  with(far_wall, [](analysis::Snapshot& s) { s.positions(0, 0) = 0.119; });
  EXPECT_THAT(far_wall.error(1), HasSubstr("1 of 1 runs failed"));
  EXPECT_FALSE(std::filesystem::exists(far_wall.jobs[0].folder));
  Bench lost({{"/bin/true"}});
  with(lost, [](analysis::Snapshot& s) { s.volumes *= 0.9; });
  EXPECT_THAT(lost.error(1), HasSubstr("1 of 1 runs failed"));
}

}  // namespace
}  // namespace talus::validation
