#include "analysis/statistics/numerical_uncertainty.h"

#include <gmock/gmock.h>

#include <cmath>
#include <stdexcept>

namespace talus::analysis {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(NumericalUncertainty, WorkedExample) {
  // Mean 2.0, s = 0.1. The coarse run is 0.3 off the mean, the one with half the steps 0.06 off the first seed's.
  const auto result = numerical_uncertainty({{1.9, 2.0, 2.1}, 2.3, 1.84});
  EXPECT_DOUBLE_EQ(result.value, 2.0);
  EXPECT_NEAR(*result.seed_deviation, 0.1, 1e-12);
  EXPECT_NEAR(*result.seed_standard, 0.1 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(result.grid->difference, 0.3, 1e-12);
  EXPECT_NEAR(result.grid->half_width, 0.3, 1e-12);
  EXPECT_NEAR(result.grid->standard, 0.3 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(*result.grid->seed_noise, 0.1 * std::sqrt(4.0 / 3.0), 1e-12);
  EXPECT_NEAR(result.time_step->difference, -0.06, 1e-12);
  EXPECT_NEAR(result.time_step->half_width, 0.12, 1e-12);
  EXPECT_NEAR(result.time_step->standard, 0.12 / std::sqrt(3.0), 1e-12);
  EXPECT_NEAR(*result.time_step->seed_noise, 0.1 * std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(*result.combined, std::sqrt((0.01 + 0.09 + 0.0144) / 3.0), 1e-12);
  EXPECT_THAT(result.missing, IsEmpty());
}

/// f(h, dt) of a first-order method: the half-widths are the errors themselves, whatever the ratios.
TEST(NumericalUncertainty, HalfWidthsAreTheErrorsOfAFirstOrderMethod) {
  constexpr double truth = 5.0, of_grid = -0.7, of_step = 0.4;
  const auto f = [&](double h, double dt) { return truth + of_grid * h + of_step * dt; };
  for (const double r : {1.5, 2.0, 4.0}) {
    const auto result = numerical_uncertainty({{f(1.0, 1.0)}, f(r, 1.0), f(1.0, 1.0 / r), r, r});
    EXPECT_NEAR(result.grid->half_width, std::abs(of_grid), 1e-12);
    EXPECT_NEAR(result.time_step->half_width, std::abs(of_step), 1e-12);
  }
}

TEST(NumericalUncertainty, BoundsTheErrorsOfASecondOrderMethod) {
  const auto f = [](double h, double dt) { return 5.0 + 0.3 * h * h - 0.2 * dt * dt; };
  const auto result = numerical_uncertainty({{f(1.0, 1.0)}, f(2.0, 1.0), f(1.0, 0.5)});
  EXPECT_GE(result.grid->half_width, 0.3);
  EXPECT_GE(result.time_step->half_width, 0.2);
}

TEST(NumericalUncertainty, WhatIsNotThereIsAbsentNotZero) {
  const auto single = numerical_uncertainty({{2.0}, std::nullopt, 2.1});
  EXPECT_FALSE(single.seed_deviation || single.seed_standard || single.grid);
  EXPECT_FALSE(single.time_step->seed_noise);
  EXPECT_NEAR(*single.combined, 0.2 / std::sqrt(3.0), 1e-12);
  EXPECT_THAT(single.missing, ElementsAre("seeds", "grid"));
  const auto seeds = numerical_uncertainty({{2.0, 2.2}, std::nullopt, std::nullopt});
  EXPECT_NEAR(*seeds.combined, 0.1, 1e-12);
  EXPECT_THAT(seeds.missing, ElementsAre("grid", "time_step"));
  const auto nothing = numerical_uncertainty({{2.0}, std::nullopt, std::nullopt});
  EXPECT_FALSE(nothing.combined);
  EXPECT_THAT(nothing.missing, ElementsAre("seeds", "grid", "time_step"));
}

TEST(NumericalUncertainty, WhatCannotBeUsed) {
  EXPECT_THROW(numerical_uncertainty({}), std::invalid_argument);
  EXPECT_THROW(numerical_uncertainty({{NAN}, {}, {}}), std::invalid_argument);
  EXPECT_THROW(numerical_uncertainty({{1.0}, INFINITY, {}}), std::invalid_argument);
  EXPECT_THROW(numerical_uncertainty({{1.0}, {}, {}, 1.0}), std::invalid_argument);
  EXPECT_THROW(numerical_uncertainty({{1.0}, {}, {}, 2.0, 0.5}), std::invalid_argument);
}

}  // namespace
}  // namespace talus::analysis
