#include "analysis/statistics/model_bias.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace talus::analysis {
namespace {

using ::testing::HasSubstr;

/// Pairs with given ln(M / E), at references of all sizes.
std::vector<ModelPair> pairs_of(std::initializer_list<double> log_ratios) {
  std::vector<ModelPair> pairs;
  double reference = 0.01;
  for (const double y : log_ratios) {
    pairs.push_back({reference * std::exp(y), reference});
    reference *= 7.0;
  }
  return pairs;
}

TEST(ModelBias, WorkedExample) {
  // Mean 0.1, s^2 = 0.1 / 4 = 0.025; with sigma_E^2 = 0.01 there is sigma_M^2 = 0.015 and ln delta = 0.1 + 0.0075 - 0.005.
  const auto result = model_bias(pairs_of({0.1, 0.2, 0.0, -0.1, 0.3}), 0.1);
  ASSERT_TRUE(result.found) << result.why_not;
  const ModelBias& bias = *result.found;
  EXPECT_NEAR(bias.bias_factor, std::exp(0.1025), 1e-12);
  EXPECT_NEAR(bias.model_deviation, std::sqrt(0.015), 1e-12);
  EXPECT_DOUBLE_EQ(bias.reference_deviation, 0.1);
  EXPECT_FALSE(bias.reference_capped);
  // t_4 = 2.7764451 of tables; chi^2_4 = 0.4844186 and 11.1432868, of which the second leaves nothing above sigma_E^2.
  const double half_width = 2.7764451 * std::sqrt(0.025 / 5.0 + 0.025 * 0.025 / 8.0);
  EXPECT_NEAR(std::log(bias.bias_interval.lower), 0.1025 - half_width, 1e-7);
  EXPECT_NEAR(std::log(bias.bias_interval.upper), 0.1025 + half_width, 1e-7);
  EXPECT_EQ(bias.model_deviation_interval.lower, 0.0);
  EXPECT_NEAR(bias.model_deviation_interval.upper, std::sqrt(0.1 / 0.4844186 - 0.01), 1e-6);
}

TEST(ModelBias, AReferenceWithoutDeviationLeavesAllToTheModel) {
  const ModelBias bias = *model_bias(pairs_of({0.1, 0.2, 0.0, -0.1, 0.3}), 0.0).found;
  EXPECT_NEAR(bias.bias_factor, std::exp(0.1 + 0.0125), 1e-12);
  EXPECT_NEAR(bias.model_deviation, std::sqrt(0.025), 1e-12);
  EXPECT_NEAR(bias.model_deviation_interval.lower, std::sqrt(0.1 / 11.1432868), 1e-7);
}

TEST(ModelBias, AModelIsNotShownToBeBetterThanItsReference) {
  const ModelBias bias = *model_bias(pairs_of({0.1, 0.2, 0.0, -0.1, 0.3}), 0.5).found;
  EXPECT_TRUE(bias.reference_capped);
  EXPECT_NEAR(bias.reference_deviation, std::sqrt(0.0125), 1e-12);
  EXPECT_NEAR(bias.model_deviation, std::sqrt(0.0125), 1e-12);
  EXPECT_NEAR(bias.bias_factor, std::exp(0.1), 1e-12);
  EXPECT_NEAR(std::log(bias.bias_interval.upper), 0.1 + 2.7764451 * std::sqrt(0.025 / 5.0), 1e-7);
}

TEST(ModelBias, SaysWhyThereIsNone) {
  const auto expect_none = [](std::vector<ModelPair> pairs, const char* why) {
    const auto result = model_bias(pairs, 0.05);
    EXPECT_FALSE(result.found);
    EXPECT_THAT(result.why_not, HasSubstr(why));
  };
  expect_none({}, "0 points; a spread needs at least 3");
  expect_none(pairs_of({0.1, 0.2}), "2 points; a spread needs at least 3");
  expect_none({{1.0, 1.0}, {0.0, 1.0}, {1.0, 1.0}}, "point 2 of 3 has a value of 0");
  expect_none({{1.0, 1.0}, {1.0, 1.0}, {1.0, -2.0}}, "point 3 of 3 has a value of -2");
  expect_none({{1.0, 1.0}, {1.0, std::numeric_limits<double>::quiet_NaN()}, {1.0, 1.0}}, "point 2 of 3");
  EXPECT_TRUE(model_bias(pairs_of({0.1, 0.2, 0.0}), 0.05).found);
}

TEST(ModelBias, RefusesNumbersThatMeanNothing) {
  const auto pairs = pairs_of({0.1, 0.2, 0.0});
  EXPECT_THROW(model_bias(pairs, -0.1), std::invalid_argument);
  EXPECT_THROW(model_bias(pairs, std::numeric_limits<double>::infinity()), std::invalid_argument);
  EXPECT_THROW(model_bias(pairs, 0.1, 1.0), std::invalid_argument);
}

TEST(ModelBias, IntervalsHoldTheTruthAsOftenAsTheySay) {
  constexpr double delta = 1.08, sigma_model = 0.10, sigma_reference = 0.04;
  constexpr int trials = 2000, points = 12;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  int bias_held = 0, deviation_held = 0;
  double mean_bias = 0.0;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<ModelPair> pairs;
    for (int i = 0; i < points; ++i)
      pairs.push_back({delta * (1.0 + sigma_model * normal(random)), 1.0 + sigma_reference * normal(random)});
    const ModelBias bias = *model_bias(pairs, sigma_reference, 0.9).found;
    const auto holds = [](const Interval& interval, double value) {
      return interval.lower <= value && value <= interval.upper;
    };
    bias_held += holds(bias.bias_interval, delta);
    deviation_held += holds(bias.model_deviation_interval, sigma_model);
    mean_bias += bias.bias_factor / trials;
  }
  // Three standard errors of a share of 0.9 in 2000, and what the delta method leaves out.
  EXPECT_NEAR(bias_held, 0.9 * trials, 0.03 * trials);
  EXPECT_NEAR(deviation_held, 0.9 * trials, 0.03 * trials);
  EXPECT_NEAR(mean_bias, delta, 0.003);
}

}  // namespace
}  // namespace talus::analysis
