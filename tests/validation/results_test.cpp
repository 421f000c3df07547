// Judging whole results: what a part of a suite may say, and nothing at all.
#include "validation/results.h"

#include <gtest/gtest.h>

#include "tests/test_folder.h"

namespace talus::validation {
namespace {

using nlohmann::json;

/// One point that passes: continuum and both discrete codes about one value.
json passing() {
  json runs = json::array();
  for (const auto& [code, seed] : std::vector<std::pair<std::string, int>>{{"continuum", 1},
                                                                           {"continuum", 2},
                                                                           {"continuum_coarse", 1},
                                                                           {"continuum_short_steps", 1},
                                                                           {"liggghts", 1},
                                                                           {"liggghts", 2},
                                                                           {"yade", 1},
                                                                           {"yade", 2}}) {
    runs.push_back({{"code", code}, {"seed", seed}, {"observables", {{"x95", 1.0 + 0.001 * seed}}}});
  }
  const json point{
      {"name", "column/a_1"},
      {"kind", "column_collapse"},
      {"runs", runs},
      {"bands",
       {{{"observable", "x95"}, {"unit", "L0"}, {"band", 0.05}, {"why", "test"}, {"measuring", 0.0}}}}};
  return {{"suite", "small"}, {"points", {point}}};
}

std::string verdict_of(json results) {
  const testing::TestFolder baseline;
  judge(results, baseline.path());
  return results.at("verdict");
}

TEST(Judge, APartOfASuiteDoesNotPassForTheWhole) {
  json results = passing();
  EXPECT_EQ(verdict_of(results), "PASS");
  results["tag"] = "quick";
  EXPECT_EQ(verdict_of(results), "INCONCLUSIVE");
}

TEST(Judge, NothingToJudgeIsNoPass) {
  json results = passing();
  results["points"] = json::array();
  EXPECT_EQ(verdict_of(results), "INCONCLUSIVE");
  // What the continuum does not run neither passes nor stands in the way of what it does.
  results = passing();
  json heap = results["points"][0];
  heap["name"] = "heap/radius_8d";
  heap["runs"] = json::array({heap["runs"][4]});
  results["points"].push_back(heap);
  EXPECT_EQ(verdict_of(results), "PASS");
  results["points"].erase(0);
  EXPECT_EQ(verdict_of(results), "INCONCLUSIVE");
}

}  // namespace
}  // namespace talus::validation
