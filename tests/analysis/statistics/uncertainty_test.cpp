#include "analysis/statistics/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace talus::analysis {
namespace {

TEST(Uncertainty, TwoCodesWithSeeds) {
  // Deviations 1 (of three) and sqrt(2) (of two): s^2 = (2 x 1 + 1 x 2) / 3.
  const auto result = combine_uncertainty(
      std::vector<CodeValues>{{"liggghts", {9.0, 10.0, 11.0}}, {"yade", {13.0, 15.0}}}, 0.5);
  EXPECT_DOUBLE_EQ(result.value, 12.0);
  EXPECT_DOUBLE_EQ(*result.codes[0].standard_error, 1.0 / std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(*result.codes[1].standard_error, 1.0);
  EXPECT_EQ(result.seed_degrees_of_freedom, 3);
  EXPECT_DOUBLE_EQ(*result.seed_deviation, std::sqrt(4.0 / 3.0));
  EXPECT_DOUBLE_EQ(*result.seed_standard, std::sqrt(4.0 / 3.0 * (1.0 / 3.0 + 1.0 / 2.0)) / 2.0);
  EXPECT_DOUBLE_EQ(*result.code_difference, 4.0);
  EXPECT_DOUBLE_EQ(*result.code_standard, 2.0 / std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(*result.combined, std::sqrt(10.0 / 36.0 + 4.0 / 3.0 + 0.25));
}

TEST(Uncertainty, ASingleSeedHasNoSpreadButTakesPartInTheValue) {
  const auto result =
      combine_uncertainty(std::vector<CodeValues>{{"liggghts", {9.0, 10.0, 11.0}}, {"yade", {12.0}}}, 0.0);
  EXPECT_DOUBLE_EQ(result.value, 11.0);
  EXPECT_TRUE(std::isnan(result.codes[1].statistics.standard_deviation));
  EXPECT_FALSE(result.codes[1].standard_error.has_value());
  // Yade's one run scatters as liggghts' runs do.
  EXPECT_DOUBLE_EQ(*result.seed_standard, std::sqrt(1.0 / 3.0 + 1.0) / 2.0);
  EXPECT_TRUE(result.combined.has_value());
}

TEST(Uncertainty, NoSpreadIsAbsentNotZero) {
  const auto result =
      combine_uncertainty(std::vector<CodeValues>{{"liggghts", {9.0}}, {"yade", {12.0}}}, 0.1);
  EXPECT_EQ(result.seed_degrees_of_freedom, 0);
  EXPECT_FALSE(result.seed_deviation.has_value());
  EXPECT_FALSE(result.seed_standard.has_value());
  EXPECT_FALSE(result.combined.has_value());
  EXPECT_DOUBLE_EQ(*result.code_difference, 3.0);
}

TEST(Uncertainty, OneCodeHasNoCodeDifference) {
  const auto result = combine_uncertainty(std::vector<CodeValues>{{"liggghts", {9.0, 10.0, 11.0}}}, 0.5);
  EXPECT_FALSE(result.code_difference.has_value());
  EXPECT_FALSE(result.code_standard.has_value());
  EXPECT_DOUBLE_EQ(*result.combined, std::sqrt(1.0 / 3.0 + 0.25));
}

TEST(Uncertainty, TheSeedTermIsTheScatterOfTheValue) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal(0.0, 0.3);
  constexpr int trials = 2000;
  double squared_deviation = 0.0, squared_seed = 0.0;
  for (int trial = 0; trial < trials; ++trial) {
    const auto draw = [&](double mean) { return mean + normal(generator); };
    const auto result = combine_uncertainty(
        std::vector<CodeValues>{{"a", {draw(1.0), draw(1.0), draw(1.0)}}, {"b", {draw(3.0)}}}, 0.0);
    squared_deviation += std::pow(result.value - 2.0, 2) / trials;
    squared_seed += std::pow(*result.seed_standard, 2) / trials;
  }
  EXPECT_NEAR(squared_seed / squared_deviation, 1.0, 0.12);  // three times sqrt(2/2000 + 1/2000)
}

TEST(Uncertainty, WhatCannotBeCombined) {
  EXPECT_THROW(combine_uncertainty({}, 0.0), std::invalid_argument);
  EXPECT_THROW(combine_uncertainty(std::vector<CodeValues>{{"a", {}}}, 0.0), std::invalid_argument);
  EXPECT_THROW(combine_uncertainty(std::vector<CodeValues>{{"a", {NAN}}}, 0.0), std::invalid_argument);
  EXPECT_THROW(combine_uncertainty(std::vector<CodeValues>{{"a", {1.0}}}, -1.0), std::invalid_argument);
  EXPECT_THROW(combine_uncertainty(std::vector<CodeValues>{{"a", {1.0}}, {"a", {2.0}}}, 0.0),
               std::invalid_argument);
}

}  // namespace
}  // namespace talus::analysis
