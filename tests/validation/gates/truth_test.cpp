// The truth gate on made-up runs: what passes, what fails, what cannot be told.
#include "validation/gates/truth.h"

#include <gmock/gmock.h>

namespace talus::validation {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

json run(const std::string& code, int seed, const json& x95) {
  return {{"code", code},
          {"seed", seed},
          {"observables", {{"x95", x95}, {"at_rest", true}}},
          {"solver", code.starts_with("continuum") ? json{{"converged", true}} : json()}};
}

/// Two lattice seeds, both refinements, and two seeds of each discrete code; all about one value unless changed.
struct Point {
  double continuum = 1.0, lattice_spread = 0.001;
  double coarse = 1.0, short_steps = 1.0;
  double liggghts = 1.0, yade = 1.0, seed_spread = 0.002;
  double band = 0.05, measuring = 0.0;

  json operator()() const {
    json runs = json::array();
    for (const int seed : {1, 2}) {
      const double sign = seed == 1 ? -1.0 : 1.0;
      runs.push_back(run("continuum", seed, continuum + sign * lattice_spread));
      runs.push_back(run("liggghts", seed, liggghts + sign * seed_spread));
      runs.push_back(run("yade", seed, yade + sign * seed_spread));
    }
    // The refinement is of the first seed.
    runs.push_back(run("continuum_coarse", 1, continuum - lattice_spread + coarse - 1.0));
    runs.push_back(run("continuum_short_steps", 1, continuum - lattice_spread + short_steps - 1.0));
    return {{"name", "column/a_1"},
            {"runs", runs},
            {"bands",
             {{{"observable", "x95"},
               {"unit", "L0"},
               {"band", band},
               {"why", "test"},
               {"measuring", measuring}}}}};
  }
};

TEST(TruthGate, PassesInsideTheBandOnly) {
  for (const double inside : {0.96, 1.0, 1.04})
    EXPECT_EQ(judge_truth(Point{.continuum = inside}()).verdict, Verdict::pass) << inside;
  for (const double outside : {0.93, 1.07})
    EXPECT_EQ(judge_truth(Point{.continuum = outside}()).verdict, Verdict::fail) << outside;
}

TEST(TruthGate, ReportsTheFiguresItJudgedBy) {
  const json row =
      judge_truth(Point{.continuum = 1.1, .liggghts = 0.9, .yade = 1.1, .measuring = 0.03}()).rows.at(0);
  EXPECT_NEAR(row["deviation"].get<double>(), 0.1, 1e-12);
  EXPECT_NEAR(row["reference"].get<double>(), 1.0, 1e-12);
  EXPECT_NEAR(row["liggghts"]["mean"].get<double>(), 0.9, 1e-12);
  EXPECT_EQ(row["yade"]["n"], 2);
  EXPECT_EQ(row["band"], 0.05);
  const auto& reference = row["u_reference"];
  // Half the difference of the codes' means over sqrt(3); the deviation of a run is 0.002 sqrt(2), of the value half of that.
  EXPECT_NEAR(reference["codes"].get<double>(), 0.1 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(reference["seeds"].get<double>(), 0.001 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(reference["measuring"].get<double>(), 0.03, 1e-12);
  const double u_reference = std::hypot(0.1 / std::sqrt(3.0), 0.001 * std::sqrt(2.0), 0.03);
  EXPECT_NEAR(reference["combined"].get<double>(), u_reference, 1e-12);
  const double u_numerical = row["u_numerical"]["combined"];
  EXPECT_GE(u_numerical, row["u_numerical"]["seeds"].get<double>());
  EXPECT_NEAR(row["uncertainty"].get<double>(), 2.0 * std::hypot(u_reference, u_numerical), 1e-12);
}

TEST(TruthGate, ALawNeedsNoDiscreteCode) {
  const auto judged = [](double continuum, double lattice_spread) {
    json point = Point{.continuum = continuum, .lattice_spread = lattice_spread, .yade = 1.5, .band = 0.01}();
    point["bands"][0]["exact"] = 1.0;
    return judge_truth(point);
  };
  const auto row = judged(1.005, 1e-4).rows.at(0);
  EXPECT_EQ(row["verdict"], "PASS") << row.dump();
  EXPECT_EQ(row["reference"], 1.0);
  EXPECT_EQ(row["u_reference"]["combined"], 0.0);
  EXPECT_TRUE(row["yade"].is_null());
  EXPECT_EQ(row["continuum"]["n"], 2);
  EXPECT_EQ(judged(1.03, 1e-4).verdict, Verdict::fail);
  EXPECT_EQ(judged(0.97, 1e-4).verdict, Verdict::fail);
  EXPECT_EQ(judged(1.005, 0.02).verdict, Verdict::inconclusive);  // its own numbers are too uncertain
  EXPECT_EQ(judged(std::nan(""), 1e-4).verdict, Verdict::inconclusive);
}

TEST(TruthGate, IsInconclusiveWhenTheReferenceCannotTell) {
  // Codes 8 % apart: u = 0.023, U = 4.6 %, less than the band; what lies between band and band + U is open.
  const Point apart{.liggghts = 0.96, .yade = 1.04};
  const auto at = [&](double continuum) {
    Point point = apart;
    point.continuum = continuum;
    return judge_truth(point());
  };
  EXPECT_EQ(at(1.0).verdict, Verdict::pass);
  EXPECT_EQ(at(1.08).verdict, Verdict::inconclusive);
  EXPECT_EQ(at(1.12).verdict, Verdict::fail);
  // However near the mean: a reference less certain than the band cannot confirm anything.
  const auto far_apart = judge_truth(Point{.liggghts = 0.9, .yade = 1.1}());
  EXPECT_EQ(far_apart.verdict, Verdict::inconclusive);
  EXPECT_THAT(far_apart.rows[0]["why"].get<std::string>(), HasSubstr("the reference's"));
}

TEST(TruthGate, IsInconclusiveWhenTheContinuumHangsOnItsCells) {
  const auto judgement = judge_truth(Point{.coarse = 1.2}());
  EXPECT_EQ(judgement.verdict, Verdict::inconclusive);
  EXPECT_THAT(judgement.rows[0]["why"].get<std::string>(), HasSubstr("the continuum's own"));
  EXPECT_EQ(judge_truth(Point{.short_steps = 1.2}()).verdict, Verdict::inconclusive);
}

/// Without the runs that `gone` names.
json without(json point, const std::function<bool(const json&)>& gone) {
  json runs = json::array();
  for (const auto& run : point["runs"]) {
    if (!gone(run)) runs.push_back(run);
  }
  point["runs"] = runs;
  return point;
}

TEST(TruthGate, NeverPassesWhatIsNotKnown) {
  const json whole = Point{}();
  ASSERT_EQ(judge_truth(whole).verdict, Verdict::pass);
  const auto code_is = [](const std::string& code) {
    return [code](const json& run) { return run["code"] == code; };
  };
  for (const std::string code : {"continuum", "continuum_coarse", "continuum_short_steps"}) {
    EXPECT_EQ(judge_truth(without(whole, code_is(code))).verdict, Verdict::inconclusive) << code;
  }
  const auto discrete = [](const json& run) { return run["code"] == "liggghts" || run["code"] == "yade"; };
  EXPECT_EQ(judge_truth(without(whole, discrete)).verdict, Verdict::inconclusive);
  // One run of each code tells nothing of the seeds.
  const auto second = [&](const json& run) { return discrete(run) && run["seed"] == 2; };
  EXPECT_EQ(judge_truth(without(whole, second)).verdict, Verdict::inconclusive);
  // One code alone tells nothing of the codes' spread, unless other points have told it.
  const json alone = without(whole, code_is("yade"));
  EXPECT_EQ(judge_truth(alone).verdict, Verdict::inconclusive);
  const auto borrowed = judge_truth(alone, {{"x95", 0.01}});
  EXPECT_EQ(borrowed.verdict, Verdict::pass);
  EXPECT_EQ(borrowed.rows[0]["u_reference"]["codes"], 0.01);
  EXPECT_GT(borrowed.rows[0]["u_reference"]["combined"].get<double>(), 0.01);
  EXPECT_EQ(judge_truth(alone, {{"x95", 0.2}}).verdict, Verdict::inconclusive);
  EXPECT_EQ(judge_truth({{"name", "x"}, {"runs", json::array()}, {"bands", whole["bands"]}}).verdict,
            Verdict::inconclusive);
}

TEST(TruthGate, NeverPassesWhatIsNotFiniteMovingOrUnconverged) {
  const json whole = Point{}();
  for (std::size_t i = 0; i < whole["runs"].size(); ++i) {
    json changed = whole;
    changed["runs"][i]["observables"]["x95"] = nullptr;
    EXPECT_EQ(judge_truth(changed).verdict, Verdict::inconclusive) << i;
    changed = whole;
    changed["runs"][i]["observables"].erase("x95");
    EXPECT_EQ(judge_truth(changed).verdict, Verdict::inconclusive) << i;
    changed = whole;
    changed["runs"][i]["observables"]["at_rest"] = false;
    const auto moving = judge_truth(changed);
    EXPECT_EQ(moving.rows[0]["verdict"], "INCONCLUSIVE") << i;
    // A model that moves on where grains rest is wrong; grains that move on tell nothing.
    EXPECT_EQ(moving.rows[1]["observable"], "at_rest");
    const std::string code = changed["runs"][i]["code"];
    EXPECT_EQ(moving.rows[1]["verdict"], code == "continuum"                    ? "FAIL"
                                         : code == "liggghts" || code == "yade" ? "INCONCLUSIVE"
                                                                                : "PASS");
  }
  json unconverged = whole;
  unconverged["runs"][0]["solver"]["converged"] = false;
  const auto judgement = judge_truth(unconverged);
  EXPECT_EQ(judgement.verdict, Verdict::inconclusive);
  EXPECT_THAT(judgement.rows[0]["why"].get<std::string>(), HasSubstr("unconverged"));
}

TEST(TruthGate, ComparesWholeProfilesByTheAreaBetweenThem) {
  json point = Point{}();
  point["bands"] = {
      {{"observable", "profile_L1"}, {"unit", "1"}, {"band", 0.12}, {"why", "test"}, {"measuring", 0.0}}};
  const auto set = [&](const std::string& code, double height) {
    for (auto& run : point["runs"]) {
      const double own = height + (run["seed"] == 1 ? -0.001 : 0.001);
      if (run["code"].get<std::string>().starts_with(code))
        run["final_profile"] = {{"x", {0.0, 1.0}}, {"depth", {own, own}}};
    }
  };
  set("liggghts", 1.0);
  set("yade", 1.0);
  set("continuum", 1.1);
  const auto near = judge_truth(point);
  EXPECT_NEAR(near.rows[0]["deviation"].get<double>(), 0.1, 1e-9);
  EXPECT_EQ(near.verdict, Verdict::pass) << near.rows.dump(1);
  set("continuum", 0.8);
  EXPECT_NEAR(judge_truth(point).rows[0]["deviation"].get<double>(), 0.2, 1e-9);
  EXPECT_EQ(judge_truth(point).verdict, Verdict::fail);
  set("continuum", 1.1);
  for (std::size_t i = 0; i < point["runs"].size(); ++i) {
    json lacking = point;
    lacking["runs"][i].erase("final_profile");
    EXPECT_EQ(judge_truth(lacking).verdict, Verdict::inconclusive) << i;
  }
}

TEST(TruthGate, ComparesDepthsInTimeByTheAreaBetweenThem) {
  json point = Point{}();
  point["bands"] = {
      {{"observable", "depth_curve_L1"}, {"unit", "1"}, {"band", 0.12}, {"why", "test"}, {"measuring", 0.0}}};
  const auto judged = [&](double continuum) {
    for (auto& run : point["runs"]) {
      const bool ours = run["code"].get<std::string>().starts_with("continuum");
      const double depth = (ours ? continuum : 1.0) + (run["seed"] == 1 ? -0.001 : 0.001);
      run["curves"] = {{"time", {0.0, 0.1, 0.2}}, {"depth", {0.0, depth, depth}}};
      run["final_profile"] = {{"x", {0.0, 1.0}}, {"depth", {1.0, 1.0}}};  // not what is compared
    }
    return judge_truth(point);
  };
  EXPECT_NEAR(judged(1.1).rows[0]["deviation"].get<double>(), 0.1, 1e-9);
  EXPECT_EQ(judged(1.1).verdict, Verdict::pass);
  EXPECT_EQ(judged(0.8).verdict, Verdict::fail);
  point["runs"][0].erase("curves");
  EXPECT_EQ(judge_truth(point).verdict, Verdict::inconclusive);
}

TEST(TruthGate, TakesTheRatioOfStepsFromTheRunsThemselves) {
  const auto u_step = [](int steps) {
    json point = Point{.short_steps = 1.01}();
    for (auto& run : point["runs"]) {
      if (run["code"] == "continuum") run["solver"]["steps"] = 200;
      if (run["code"] == "continuum_short_steps") run["solver"]["steps"] = steps;
    }
    return judge_truth(point).rows[0]["u_numerical"]["time_step"].get<double>();
  };
  EXPECT_NEAR(u_step(400), 2.0 * 0.01 / std::sqrt(3.0), 1e-9);  // a = difference r / (r - 1)
  EXPECT_NEAR(u_step(300), 3.0 * 0.01 / std::sqrt(3.0), 1e-9);
}

TEST(TruthGate, TheWorstObservableDecides) {
  EXPECT_EQ(worse(Verdict::pass, Verdict::inconclusive), Verdict::inconclusive);
  EXPECT_EQ(worse(Verdict::fail, Verdict::inconclusive), Verdict::fail);
  EXPECT_EQ(worse(Verdict::pass, Verdict::pass), Verdict::pass);
  json point = Point{}();
  for (auto& run : point["runs"]) run["observables"]["x90"] = run["code"] == "continuum" ? 2.0 : 1.0;
  point["bands"].push_back(
      {{"observable", "x90"}, {"unit", "L0"}, {"band", 0.05}, {"why", "test"}, {"measuring", 0.0}});
  EXPECT_EQ(judge_truth(point).verdict,
            Verdict::inconclusive);  // the refinement of x90 lies far off its runs
  for (auto& run : point["runs"]) {
    if (run["code"].get<std::string>().starts_with("continuum")) run["observables"]["x90"] = 2.0;
    if (run["code"] == "liggghts" && run["seed"] == 2) run["observables"]["x90"] = 1.001;
  }
  EXPECT_EQ(judge_truth(point).verdict, Verdict::fail);
}

}  // namespace
}  // namespace talus::validation
