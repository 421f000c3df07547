// Figures of a whole suite, on made-up results whose answers are known.
#include "validation/metrics.h"

#include <gmock/gmock.h>

#include <cmath>

namespace talus::validation {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

/// A point of one truth row.
json point(double deviation, double u_reference = 0.01) {
  return {{"kind", "column_collapse"},
          {"truth",
           {{{"observable", "x95"},
             {"deviation", deviation},
             {"band", 0.05},
             {"unfit", false},
             {"u_reference", {{"combined", u_reference}}}}}}};
}

TEST(SuiteMetrics, ABiasThatAllPointsShareIsFound) {
  const json results{{"points", {point(0.10), point(0.11), point(0.12), point(0.11)}}};
  const json row = suite_metrics(results).at(0);
  EXPECT_EQ(row["observable"], "x95");
  EXPECT_EQ(row["n"], 4);
  EXPECT_NEAR(row["bias_factor"].get<double>(), 1.11, 0.002);
  EXPECT_LT(row["bias_interval"][0].get<double>(), 1.11);
  EXPECT_GT(row["bias_interval"][1].get<double>(), 1.11);
  EXPECT_NEAR(row["reference_relative_sd"].get<double>(), 0.01, 1e-12);
  EXPECT_FALSE(row["equivalence"]["equivalent"].get<bool>());
  const json near{{"points", {point(0.001), point(-0.002), point(0.003), point(0.0)}}};
  EXPECT_TRUE(suite_metrics(near).at(0)["equivalence"]["equivalent"].get<bool>());
}

TEST(SuiteMetrics, SayWhyThereIsNoAnswer) {
  const json row = suite_metrics({{"points", {point(0.1)}}}).at(0);
  EXPECT_EQ(row["n"], 1);
  EXPECT_FALSE(row.contains("bias_factor"));
  EXPECT_FALSE(row["why_not"].get<std::string>().empty());
  EXPECT_TRUE(suite_metrics({{"points", json::array()}}).empty());
  json unfit = point(0.1);
  unfit["truth"][0]["unfit"] = true;
  EXPECT_TRUE(suite_metrics({{"points", {unfit, unfit, unfit}}}).empty());
}

/// A slot that drains by Beverloo's law with C = 1 and the k given.
json slot(double opening, double k) {
  constexpr double d = 0.003, density = 2500.0, fraction = 0.56, depth = 0.012;
  const double rate = density * fraction * std::sqrt(9.81) * depth * std::pow(opening - k * d, 1.5);
  json runs = json::array();
  for (const int seed : {1, 2, 3}) {
    runs.push_back(
        {{"code", "liggghts"},
         {"seed", seed},
         {"observables",
          {{"discharge_rate", rate * (1.0 + 0.001 * (seed - 2))}, {"discharge_rate_error", 0.001 * rate}}}});
  }
  return {{"kind", "slot"},
          {"truth", json::array()},
          {"calibration", {{"name", "sand"}}},
          {"parameters",
           {{"grains", {{"diameter_m", d}, {"density_kg_m3", density}}},
            {"protocol", {{"volume_fraction", fraction}, {"gravity_m_s2", 9.81}}},
            {"geometry", {{"opening_m", opening}, {"thickness_m", depth}}}}},
          {"runs", runs}};
}

TEST(BeverlooFits, FindTheLawThatTheSlotsFollow) {
  const json fits = beverloo_fits({{"points", {slot(0.018, 1.35), slot(0.024, 1.35), slot(0.036, 1.35)}}});
  ASSERT_EQ(fits.size(), 1u);
  EXPECT_EQ(fits[0]["code"], "liggghts");
  EXPECT_EQ(fits[0]["material"], "sand");
  ASSERT_TRUE(fits[0].contains("C")) << fits[0].dump(1);
  EXPECT_NEAR(fits[0]["C"].get<double>(), 1.0, 1e-3);
  EXPECT_NEAR(fits[0]["k"].get<double>(), 1.35, 1e-3);
  EXPECT_NEAR(fits[0]["exponent"].get<double>(), 1.5, 0.02);  // at k = 1.4
  EXPECT_EQ(fits[0]["points"].size(), 3u);
}

TEST(BeverlooFits, TheExponentIsThatOfTheRatesNotThatOfTheLaw) {
  json points = json::array();
  for (const double opening : {0.018, 0.024, 0.036}) {
    json point = slot(opening, 1.4);
    for (auto& run : point["runs"]) {  // of (D - k d) / d to the power 2 instead of 3/2
      auto& rate = run["observables"]["discharge_rate"];
      rate = rate.get<double>() * std::sqrt((opening - 1.4 * 0.003) / 0.003);
    }
    points.push_back(point);
  }
  EXPECT_NEAR(beverloo_fits({{"points", points}})[0]["exponent"].get<double>(), 2.0, 1e-3);
}

TEST(BeverlooFits, TwoOpeningsHaveRatesAndNoFit) {
  const json fits = beverloo_fits({{"points", {slot(0.018, 1.3), slot(0.024, 1.3)}}});
  EXPECT_EQ(fits[0]["points"].size(), 2u);
  EXPECT_FALSE(fits[0].contains("C"));
}

}  // namespace
}  // namespace talus::validation
