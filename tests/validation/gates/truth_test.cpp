// The truth gate: what passes, what fails, and what can never pass.
#include "validation/gates/truth.h"

#include <gmock/gmock.h>

namespace talus::validation {
namespace {

using nlohmann::json;

json run(const std::string& backend, int seed, const json& x95) {
  return {{"backend", backend},
          {"seed", seed},
          {"status", "ok"},
          {"observables", {{"x95", x95}, {"at_rest", true}}},
          {"solver", backend == "continuum" ? json{{"converged", true}} : json()}};
}

json runs(const json& continuum, double liggghts, double yade) {
  return {run("continuum", 1, continuum), run("liggghts", 1, liggghts), run("yade", 1, yade)};
}

TruthJudgement judge(const json& all) {
  const std::vector<dem::ObservableBand> bands{{"x95", 0.05, "test"}};
  return judge_truth(bands, all);
}

TEST(TruthGate, PassesInsideTheBandOnly) {
  EXPECT_EQ(judge(runs(1.04, 0.999, 1.001)).verdict, Verdict::pass);
  EXPECT_EQ(judge(runs(0.96, 0.999, 1.001)).verdict, Verdict::pass);
  EXPECT_EQ(judge(runs(1.06, 0.999, 1.001)).verdict, Verdict::fail);
  EXPECT_EQ(judge(runs(0.94, 0.999, 1.001)).verdict, Verdict::fail);
}

TEST(TruthGate, ReportsTheFiguresItJudgedBy) {
  const json entry = judge(runs(1.1, 0.9, 1.1)).summary.at(0);
  EXPECT_NEAR(entry["deviation"].get<double>(), 0.1, 1e-12);
  EXPECT_NEAR(entry["reference"]["mean"].get<double>(), 1.0, 1e-12);
  EXPECT_NEAR(entry["reference"]["sd"].get<double>(), 0.1 * std::sqrt(2.0), 1e-12);
  EXPECT_EQ(entry["reference"]["n"], 2);
  EXPECT_EQ(entry["liggghts"]["mean"], 0.9);
  EXPECT_EQ(entry["band"], 0.05);
}

TEST(TruthGate, IsInconclusiveWhenTheReferenceScattersTooMuchToTell) {
  // 2 s / sqrt n = 0.1: a deviation of 8 % is outside the band but within what the reference can tell.
  EXPECT_EQ(judge(runs(1.08, 0.95, 1.05)).verdict, Verdict::inconclusive);
  EXPECT_EQ(judge(runs(1.16, 0.95, 1.05)).verdict, Verdict::fail);
  // However near the mean: a reference less certain than the band cannot confirm anything, nor can a single run.
  EXPECT_EQ(judge(runs(1.0, 0.9, 1.1)).verdict, Verdict::inconclusive);
  json one_reference = runs(1.0, 1.0, 1.0);
  one_reference.erase(2);
  EXPECT_EQ(judge(one_reference).verdict, Verdict::inconclusive);
}

TEST(TruthGate, NeverPassesWhatIsMissingNotFiniteMovingOrUnconverged) {
  EXPECT_EQ(judge(runs(nullptr, 1.0, 1.0)).verdict, Verdict::inconclusive);
  json all = runs(1.0, 1.0, 1.0);
  all.erase(0);
  EXPECT_EQ(judge(all).verdict, Verdict::inconclusive);
  EXPECT_EQ(judge(json::array()).verdict, Verdict::inconclusive);
  for (const std::size_t moving : {0u, 1u, 2u}) {
    all = runs(1.0, 1.0, 1.0);
    all[moving]["observables"]["at_rest"] = false;
    EXPECT_EQ(judge(all).verdict, Verdict::inconclusive) << moving;
  }
  all = runs(1.0, 1.0, 1.0);
  all[0]["solver"]["converged"] = false;
  const auto judgement = judge(all);
  EXPECT_EQ(judgement.verdict, Verdict::inconclusive);
  EXPECT_THAT(judgement.summary[0]["why"].get<std::string>(), ::testing::HasSubstr("unconverged"));
  all = runs(1.0, 1.0, 1.0);
  all[1]["status"] = "failed";
  EXPECT_EQ(judge(all).verdict, Verdict::inconclusive);
}

TEST(TruthGate, TheWorstObservableDecides) {
  EXPECT_EQ(worse(Verdict::pass, Verdict::inconclusive), Verdict::inconclusive);
  EXPECT_EQ(worse(Verdict::fail, Verdict::inconclusive), Verdict::fail);
  EXPECT_EQ(worse(Verdict::pass, Verdict::pass), Verdict::pass);
}

}  // namespace
}  // namespace talus::validation
