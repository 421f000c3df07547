#include "analysis/statistics/robust_line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "analysis/statistics/fit_error.h"

namespace talus::analysis {
namespace {

struct Points {
  std::vector<double> x, y;
};

Points noisy_line(int count, double noise, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  Points points;
  for (int k = 0; k < count; ++k) {
    points.x.push_back(0.1 * k);
    points.y.push_back(2.0 - 0.5 * points.x.back() + noise * normal(generator));
  }
  return points;
}

TEST(RobustLine, ExactPoints) {
  const auto [x, y] = noisy_line(10, 0.0, 1);
  const auto line = fit_robust_line(x, y);
  EXPECT_NEAR(line.intercept, 2.0, 1e-12);
  EXPECT_NEAR(line.slope, -0.5, 1e-12);
  EXPECT_NEAR(line.slope_standard_error, 0.0, 1e-9);
}

TEST(RobustLine, OutliersDoNotTurnIt) {
  auto [x, y] = noisy_line(40, 0.01, 2);
  for (const std::size_t k : {3u, 4u, 20u, 37u}) y[k] += 5.0;
  const auto line = fit_robust_line(x, y);
  EXPECT_NEAR(line.slope, -0.5, 5.0 * line.slope_standard_error);
  EXPECT_NEAR(line.slope, -0.5, 0.01);
}

TEST(RobustLine, StandardErrorIsTheScatterOfTheSlope) {
  constexpr int trials = 400;
  double squared_deviation = 0.0, squared_error = 0.0;
  for (unsigned trial = 0; trial < trials; ++trial) {
    const auto [x, y] = noisy_line(50, 0.1, 100 + trial);
    const auto line = fit_robust_line(x, y);
    squared_deviation += std::pow(line.slope + 0.5, 2) / trials;
    squared_error += std::pow(line.slope_standard_error, 2) / trials;
  }
  EXPECT_NEAR(std::sqrt(squared_error / squared_deviation), 1.0, 0.1);  // 400 trials: known within 3.5 %
}

TEST(RobustLine, PointsThatHaveNoLine) {
  const std::vector<double> two{1.0, 2.0}, three{1.0, 2.0, 3.0}, same{1.0, 1.0, 1.0}, broken{1.0, NAN, 3.0};
  EXPECT_THROW(fit_robust_line(two, two), FitError);
  EXPECT_THROW(fit_robust_line(three, two), std::invalid_argument);
  EXPECT_THROW(fit_robust_line(same, three), FitError);
  EXPECT_THROW(fit_robust_line(three, broken), FitError);
}

}  // namespace
}  // namespace talus::analysis
