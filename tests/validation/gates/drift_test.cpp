// The drift gate and the baseline it is held against.
#include "validation/gates/drift.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "continuum/files/atomic_file.h"
#include "tests/test_folder.h"

namespace talus::validation {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

json run(const std::string& code, int seed, double x95) {
  return {{"code", code},
          {"seed", seed},
          {"observables", {{"x95", x95}, {"at_rest", true}}},
          {"solver", code == "continuum" ? json{{"converged", true}} : json()}};
}

/// Two lattice seeds 2 % apart.
json results(double x95) {
  json point{
      {"name", "column/a_1"},
      {"bands", json::array({{{"observable", "x95"}}})},
      {"runs", {run("continuum", 1, 0.99 * x95), run("continuum", 2, 1.01 * x95), run("liggghts", 1, 5.0)}}};
  return {
      {"suite", "small"}, {"points", {point}}, {"provenance", {{"git_hash", "abc"}, {"git_dirty", false}}}};
}

struct Accepted {
  testing::TestFolder folder;
  Accepted() { accept(results(2.0), "the first", folder.path()); }
  json judged(json now) const {
    judge_drift_of_suite(now, folder.path());
    return now;
  }
};

TEST(DriftGate, PassesWhatHasNotMovedAndFailsWhatHas) {
  const Accepted baseline;
  const json same = baseline.judged(results(2.0));
  EXPECT_EQ(same["drift"]["verdict"], "PASS");
  const json& row = same["points"][0]["drift"][0];
  EXPECT_EQ(row["observable"], "x95");
  EXPECT_NEAR(row["tolerance"].get<double>(), 2.0 * 0.01 * std::sqrt(2.0), 1e-12);  // 2 s sqrt(2 / n), n = 2
  EXPECT_NEAR(row["change"].get<double>(), 0.0, 1e-12);
  EXPECT_EQ(baseline.judged(results(2.056))["drift"]["verdict"], "PASS");
  EXPECT_EQ(baseline.judged(results(2.057))["drift"]["verdict"], "FAIL");
  EXPECT_EQ(baseline.judged(results(1.943))["drift"]["verdict"], "FAIL");
}

TEST(DriftGate, LooksAtWhatTheCaseIsComparedByAndWhenItStopped) {
  json now = results(2.0);
  for (auto& run : now["points"][0]["runs"]) {
    run["observables"]["lost_volume"] = 1e-15;
    run["observables"]["stop_time"] = 0.3;
  }
  const testing::TestFolder folder;
  accept(now, "the first", folder.path());
  for (auto& run : now["points"][0]["runs"]) run["observables"]["lost_volume"] = -3e-15;
  judge_drift_of_suite(now, folder.path());
  EXPECT_EQ(now["drift"]["verdict"], "PASS");
  for (auto& run : now["points"][0]["runs"]) run["observables"]["stop_time"] = 0.31;
  judge_drift_of_suite(now, folder.path());
  EXPECT_EQ(now["drift"]["verdict"], "FAIL");
}

TEST(DriftGate, KnowsNothingOfTheDiscreteCodes) {
  const Accepted baseline;
  json now = results(2.0);
  now["points"][0]["runs"][2]["observables"]["x95"] = 99.0;
  EXPECT_EQ(baseline.judged(now)["drift"]["verdict"], "PASS");
}

TEST(DriftGate, IsInconclusiveWithoutABaselineOrAValue) {
  const testing::TestFolder empty;
  json now = results(2.0);
  judge_drift_of_suite(now, empty.path());
  EXPECT_EQ(now["drift"]["verdict"], "INCONCLUSIVE");
  EXPECT_THAT(now["drift"]["why"].get<std::string>(), HasSubstr("accept"));
  const Accepted baseline;
  now = results(2.0);
  for (auto& run : now["points"][0]["runs"]) run["observables"].erase("x95");
  EXPECT_EQ(baseline.judged(now)["drift"]["verdict"], "INCONCLUSIVE");
  now = results(2.0);
  now["points"][0]["bands"].push_back({{"observable", "new"}});
  now["points"][0]["runs"][0]["observables"]["new"] = 1.0;
  now["points"][0]["runs"][1]["observables"]["new"] = 1.0;
  EXPECT_EQ(baseline.judged(now)["drift"]["verdict"], "INCONCLUSIVE");
  now = results(2.0);
  now["points"][0]["runs"][0]["solver"]["converged"] = false;
  EXPECT_EQ(baseline.judged(now)["drift"]["verdict"], "INCONCLUSIVE");
  now = results(2.0);
  now["points"] = json::array();
  EXPECT_EQ(baseline.judged(now)["drift"]["verdict"], "INCONCLUSIVE");
}

TEST(Accept, MovesTheBaselineAndTellsWhoWhatAndWhy) {
  const Accepted baseline;
  const json entry = accept(results(2.2), "a better splat", baseline.folder.path());
  EXPECT_EQ(entry["why"], "a better splat");
  EXPECT_EQ(entry["git_hash"], "abc");
  EXPECT_THAT(entry["who"].get<std::string>(), HasSubstr("@"));
  ASSERT_EQ(entry["changes"].size(), 1u);
  EXPECT_NEAR(entry["changes"][0]["old"].get<double>(), 2.0, 1e-12);
  EXPECT_NEAR(entry["changes"][0]["new"].get<double>(), 2.2, 1e-12);
  const json now = baseline.judged(results(2.2));
  EXPECT_EQ(now["drift"]["verdict"], "PASS");
  ASSERT_EQ(now["history"].size(), 2u);
  EXPECT_EQ(now["history"][0]["why"], "the first");
  EXPECT_EQ(now["history"][1]["why"], "a better splat");
}

TEST(Accept, APartMovesItsOwnPointsAndTheWholeDropsWhatItNoLongerHas) {
  const Accepted baseline;
  json part = results(2.0);
  part["tag"] = "another";
  part["points"][0]["name"] = "column/a_2";
  accept(part, "more", baseline.folder.path());
  EXPECT_EQ(read_baseline(baseline.folder.path(), "small")->at("points").size(), 2u);
  accept(results(2.0), "the point is gone", baseline.folder.path());
  EXPECT_EQ(read_baseline(baseline.folder.path(), "small")->at("points").size(), 1u);
}

TEST(Accept, RefusesWhatIsNoResult) {
  const testing::TestFolder folder;
  const auto error = [&](const json& now, const std::string& reason) {
    return testing::input_error([&] { accept(now, reason, folder.path()); });
  };
  EXPECT_THAT(error(results(2.0), "  "), HasSubstr("--reason"));
  json now = results(2.0);
  now["points"][0]["runs"][1]["solver"]["converged"] = false;
  EXPECT_THAT(error(now, "why"), HasSubstr("unconverged"));
  now = results(2.0);
  now["points"][0]["runs"][1]["observables"]["x95"] = nullptr;
  EXPECT_THAT(error(now, "why"), HasSubstr("x95 is not finite"));
  now["points"] = json::array();
  EXPECT_THAT(error(now, "why"), HasSubstr("no continuum run"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

// The name comes from stored results, whoever wrote them.
TEST(Baseline, ANameThatLeadsOutOfTheFolderIsRefused) {
  for (const std::string name : {"../escaped", "/tmp/escaped", "..", ".hidden", "", "a/b"}) {
    EXPECT_THAT(testing::input_error([&] { read_baseline("/nowhere", name); }), HasSubstr("must name a file"))
        << name;
  }
}

TEST(Baseline, ADamagedFileIsAnErrorThatNamesIt) {
  const Accepted baseline;
  const auto& folder = baseline.folder.path();
  std::ofstream(folder / "small.json") << "{";
  EXPECT_THAT(testing::input_error([&] { read_baseline(folder, "small"); }),
              HasSubstr("small.json: damaged"));
  std::ofstream(folder / "small.json")
      << R"({"schema": "talus-baseline", "schema_version": 1, "suite": "small"})";
  EXPECT_THAT(testing::input_error([&] { read_baseline(folder, "small"); }),
              HasSubstr("small.json: damaged"));
  std::ofstream(folder / "history.jsonl", std::ios::app) << "{\n";
  EXPECT_THAT(testing::input_error([&] { read_history(folder, "small"); }),
              HasSubstr("history.jsonl:2: damaged"));
}

}  // namespace
}  // namespace talus::validation
