// The runner, with programs of the system for codes: order, failures, stopping, and not making twice what is there.
#include "validation/run_suite.h"

#include <gmock/gmock.h>

#include <atomic>
#include <fstream>

#include "continuum/files/atomic_file.h"
#include "dem_cases/reference/make_run.h"
#include "tests/program.h"

namespace talus::validation {
namespace {

using ::testing::HasSubstr;

/// Runs of `commands`.
struct Bench {
  testing::TestFolder folder;
  std::vector<SuiteRun> runs;

  explicit Bench(const std::vector<std::vector<std::string>>& commands) {
    for (std::size_t i = 0; i < commands.size(); ++i) {
      dem::PlannedRun run;
      run.case_name = "column";
      run.point_name = "tiny";
      run.code = "yade";
      run.seed = i + 1;
      run.version = "test";
      run.command = commands[i];
      run.log_file = "log";
      run.expected_cpu = 1.0;
      run.time_limit = 20.0;
      run.write_input = [](const auto& where) { write_file_atomically(where / "input", "x"); };
      run.progress = [](const auto&) { return 0.5; };
      run.failure_text = [](const auto&) { return std::string("as it said"); };
      run.measure = [](const auto&) {
        return nlohmann::json{{"observables", {{"x95", 1.5}}}, {"curves", nlohmann::json::object()}};
      };
      runs.push_back({"column/tiny", run, dem::run_folder(folder.path() / "runs", run), 100.0, false});
    }
  }
  MakingOptions options(int workers = 1) const { return {.workers = workers}; }
  std::string error(const MakingOptions& how) {
    try {
      make_runs(runs, how);
    } catch (const RunError& failure) {
      return failure.what();
    }
    return "";
  }
};

TEST(MakeRuns, MakesAllWithFewerOrMoreWorkersThanRuns) {
  for (const int workers : {1, 2, 9}) {
    Bench bench({{"/bin/true"}, {"/bin/true"}, {"/bin/true"}});
    EXPECT_EQ(bench.error(bench.options(workers)), "");
    for (const auto& run : bench.runs) {
      ASSERT_TRUE(find_record(run));
      EXPECT_EQ(find_record(run)->origin, "run");
      EXPECT_EQ(find_record(run)->record["observables"]["x95"], 1.5);
    }
  }
}

TEST(MakeRuns, DoesNotMakeTwiceWhatIsThere) {
  Bench bench({{"/bin/true"}, {"/bin/true"}});
  EXPECT_EQ(make_runs(bench.runs, bench.options()), 2);
  EXPECT_EQ(make_runs(bench.runs, bench.options()), 0);
  MakingOptions force = bench.options();
  force.force = true;
  EXPECT_EQ(make_runs(bench.runs, force), 2);
  // Other inputs, another version, another ruler: another run.
  bench.runs[0].run.write_input = [](const auto& where) { write_file_atomically(where / "input", "y"); };
  EXPECT_EQ(state_of(bench.runs[0]), "stale");
  EXPECT_EQ(make_runs(bench.runs, bench.options()), 1);
  bench.runs[1].run.version = "next";
  EXPECT_EQ(make_runs(bench.runs, bench.options()), 1);
  bench.runs[1].run.measurement = {{"ruler_version", 2}};
  EXPECT_EQ(make_runs(bench.runs, bench.options()), 1);
  EXPECT_EQ(state_of(bench.runs[1]), "stored");
  std::filesystem::remove_all(bench.runs[1].folder);
  EXPECT_EQ(state_of(bench.runs[1]), "missing");
}

TEST(MakeRuns, TriesEveryRunEvenWhenAnotherFails) {
  Bench bench({{"/bin/false"}, {"/bin/true"}, {"/bin/sh", "-c", "kill -9 $$"}, {"/bin/true"}});
  EXPECT_THAT(bench.error(bench.options(2)), HasSubstr("2 of 4 runs failed"));
  EXPECT_FALSE(std::filesystem::exists(bench.runs[0].folder));
  EXPECT_TRUE(std::filesystem::exists(bench.runs[1].folder));
  EXPECT_FALSE(std::filesystem::exists(bench.runs[2].folder));
  EXPECT_TRUE(std::filesystem::exists(bench.runs[3].folder));
}

TEST(MakeRuns, StopsBetweenAndDuringRunsAndKeepsWhatWasWholeBefore) {
  Bench bench({{"/bin/true"}, {"/bin/sleep", "60"}, {"/bin/true"}});
  EXPECT_EQ(make_runs({bench.runs[2]}, bench.options()), 1);
  std::atomic<int> asked = 0;
  MakingOptions stopping = bench.options();
  stopping.stop = [&] { return ++asked > 8; };
  EXPECT_THAT(bench.error(stopping), HasSubstr("interrupted"));
  EXPECT_TRUE(std::filesystem::exists(bench.runs[0].folder));
  EXPECT_FALSE(std::filesystem::exists(bench.runs[1].folder));
  EXPECT_EQ(state_of(bench.runs[2]), "stored");
  bench.runs[1].run.command = {"/bin/true"};
  EXPECT_EQ(make_runs(bench.runs, bench.options()), 1);  // the same command makes the rest
}

TEST(MakeRuns, AMeasureThatFailsOrIsNotFiniteIsNoRun) {
  Bench bench({{"/bin/true"}, {"/bin/true"}});
  bench.runs[0].run.measure = [](const auto&) -> nlohmann::json { throw InputError("leaked"); };
  bench.runs[1].run.measure = [](const auto&) {
    return nlohmann::json{{"observables", {{"x95", std::nan("")}}}, {"curves", nlohmann::json::object()}};
  };
  EXPECT_THAT(bench.error(bench.options()), HasSubstr("2 of 2 runs failed"));
  for (const auto& run : bench.runs) EXPECT_EQ(state_of(run), "missing");
}

TEST(MakeRuns, ADamagedRecordIsAnErrorThatNamesIt) {
  Bench bench({{"/bin/true"}});
  make_runs(bench.runs, bench.options());
  std::ofstream(bench.runs[0].folder / "record.json") << "{";
  EXPECT_THAT(testing::input_error([&] { find_record(bench.runs[0]); }),
              HasSubstr("record.json: not a record"));
}

TEST(Selected, TakesNamesAndTheirBeginnings) {
  const Bench bench({{"/bin/true"}, {"/bin/true"}});
  EXPECT_EQ(selected(bench.runs, {}).size(), 2u);
  EXPECT_EQ(selected(bench.runs, {"column"}).size(), 2u);
  EXPECT_EQ(selected(bench.runs, {"column/tiny/yade"}).size(), 2u);
  ASSERT_EQ(selected(bench.runs, {"column/tiny/yade/2"}).size(), 1u);
  EXPECT_EQ(selected(bench.runs, {"column/tiny/yade/2"})[0].run.seed, 2u);
  EXPECT_THAT(testing::input_error([&] { selected(bench.runs, {"column/tiny/yad"}); }),
              HasSubstr("selects no run"));
}

}  // namespace
}  // namespace talus::validation
