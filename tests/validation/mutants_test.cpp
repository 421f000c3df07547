// What the mutation check calls found out.
#include "validation/mutants.h"

#include <gmock/gmock.h>

#include "validation/mutation.h"

namespace talus::validation {
namespace {

using ::testing::HasSubstr;

TEST(Mutants, AreTheOnesThatTheGateMustKnow) {
  EXPECT_THAT(mutant_names(),
              ::testing::IsSupersetOf({"no_friction", "friction_less_20_percent", "friction_more_20_percent",
                                       "no_wall_friction", "pressure_pulls", "no_density_correction",
                                       "gravity_less_5_percent"}));
  EXPECT_EQ(find_mutant("sound"), nullptr);
  EXPECT_EQ(find_mutant("no_friction")->defects.friction_factor, 0.0);
}

/// Of two seeds, the first with unconverged solves or not; x95 is 1.0 +- .05 in the sound solver and the discrete codes.
nlohmann::json judged(const std::vector<double>& x95, bool first_converged, bool second_converged = true) {
  const auto record = [](const std::string& code, int seed, double value, bool converged) {
    return nlohmann::json{{"code", code},
                          {"seed", seed},
                          {"observables", {{"x95", value}}},
                          {"solver", {{"converged", converged}}}};
  };
  const nlohmann::json band{
      {"observable", "x95"}, {"unit", "L0"}, {"band", 0.05}, {"why", "test"}, {"measuring", 0.0}};
  const nlohmann::json before{
      {"observable", "x95"}, {"verdict", "PASS"}, {"uncertainty", 0.02}, {"band", 0.05}, {"deviation", 0.0}};
  const nlohmann::json point{{"name", "column/a_1"},
                             {"bands", {band}},
                             {"truth", {before}},
                             {"runs", {record("liggghts", 1, 1.0, true), record("liggghts", 2, 1.0, true)}}};
  nlohmann::json mutant{{"rows", nlohmann::json::array()},
                        {"by", nlohmann::json::array()},
                        {"not_judged", nlohmann::json::array()}};
  judge_mutant(
      point,
      {record("continuum", 1, x95[0], first_converged), record("continuum", 2, x95[1], second_converged)},
      mutant);
  return mutant;
}

TEST(Mutants, AreFoundOutBeyondBandAndUncertainty) {
  EXPECT_EQ(judged({1.06, 1.06}, true)["by"].size(), 0u);
  EXPECT_EQ(judged({1.08, 1.08}, true)["by"].size(), 1u);
  EXPECT_EQ(judged({0.92, 0.92}, true)["by"][0]["observable"], "x95");
}

TEST(Mutants, WhatDidNotConvergeFindsOutNothing) {
  EXPECT_EQ(judged({9.0, 1.0}, false)["by"].size(), 0u);
  EXPECT_EQ(judged({1.0, 9.0}, false)["by"].size(), 1u);
  EXPECT_EQ(judged({1.0, 9.0}, false)["not_judged"].size(), 0u);
  const auto neither = judged({9.0, 9.0}, false, false);
  EXPECT_EQ(neither["by"].size(), 0u);
  EXPECT_EQ(neither["not_judged"].size(), 1u);
}

TEST(Mutants, TheTableSaysWhoSurvives) {
  const nlohmann::json mutants{
      {{"title", "no friction"},
       {"killed", true},
       {"by", {{{"name", "slot/a"}, {"observable", "discharge_rate"}, {"verdict", "FAIL"}}}},
       {"not_judged", nlohmann::json::array()}},
      {{"title", "gravity 5 % too small"},
       {"killed", false},
       {"by", nlohmann::json::array()},
       {"not_judged", {{{"name", "ledge/a"}, {"why", "it moved"}}}}}};
  const std::string text = mutants_text(mutants);
  EXPECT_THAT(text, HasSubstr("found out by slot/a discharge_rate"));
  EXPECT_THAT(text, HasSubstr("SURVIVES [ledge/a not judged: it moved]"));
  EXPECT_THAT(text, HasSubstr("1 of 2 mutants survive"));
}

}  // namespace
}  // namespace talus::validation
