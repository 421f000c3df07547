#include "analysis/statistics/beverloo.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "analysis/statistics/fit_error.h"

namespace talus::analysis {
namespace {

constexpr double d = 0.003;  // m
constexpr double C = 1.03, k = 1.3;
const Orifice slot{.grain_diameter = d, .bulk_density = 1450.0, .slot_depth = 4.0 * d};
const Orifice hole{.grain_diameter = d, .bulk_density = 1450.0};
const std::vector<double> openings{5.0, 6.0, 8.0, 10.0, 12.0, 15.0};  // in d

std::vector<DischargePoint> points_at(const std::vector<double>& across, const Orifice& orifice, double noise,
                                      unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<DischargePoint> points;
  for (const double opening : across) {
    const double rate = beverloo_rate(opening * d, orifice, C, k);
    points.push_back(
        {opening * d, rate * (1.0 + noise * normal(generator)), rate * (noise > 0.0 ? noise : 0.01)});
  }
  return points;
}

TEST(Beverloo, Rate) {
  EXPECT_NEAR(beverloo_rate(8.0 * d, slot, C, k),
              C * 1450.0 * std::sqrt(9.81) * 4.0 * d * std::pow(6.7 * d, 1.5), 1e-12);
  EXPECT_NEAR(beverloo_rate(8.0 * d, hole, C, k), C * 1450.0 * std::sqrt(9.81) * std::pow(6.7 * d, 2.5),
              1e-12);
  EXPECT_EQ(beverloo_rate(1.2 * d, slot, C, k), 0.0);
}

TEST(Beverloo, ExactPoints) {
  for (const Orifice& orifice : {slot, hole}) {
    const auto fit = fit_beverloo(points_at(openings, orifice, 0.0, 1), orifice);
    EXPECT_NEAR(fit.C, C, 1e-7);
    EXPECT_NEAR(fit.k, k, 1e-7);
    EXPECT_NEAR(fit.chi_squared, 0.0, 1e-9);
  }
}

/// The distance of the fit from the truth, measured in its own covariance, is chi^2 with two degrees of freedom.
TEST(Beverloo, CovarianceIsThatOfTheFits) {
  constexpr int trials = 500;
  double distance = 0.0, reduced = 0.0;
  for (unsigned trial = 0; trial < trials; ++trial) {
    const auto fit = fit_beverloo(points_at(openings, slot, 0.02, 10 + trial), slot);
    const Eigen::Vector2d error(fit.C - C, fit.k - k);
    distance += error.dot(fit.covariance.inverse() * error) / trials;
    reduced += fit.reduced_chi_squared / trials;
    EXPECT_DOUBLE_EQ(fit.standard_errors[1], std::sqrt(fit.covariance(1, 1)));
  }
  EXPECT_NEAR(distance, 2.0, 0.3);  // +- sqrt(4/500) = 0.09
  EXPECT_NEAR(reduced, 1.0, 0.1);   // +- sqrt(2/4/500) = 0.03
}

TEST(Beverloo, FreeExponent) {
  for (const Orifice& orifice : {slot, hole}) {
    const double n = orifice.slot_depth ? 1.5 : 2.5;
    const auto fit = fit_beverloo_exponent(points_at(openings, orifice, 0.0, 1), orifice);
    EXPECT_NEAR(fit.exponent, n, 1e-5);
    EXPECT_NEAR(fit.k, k, 1e-4);
    EXPECT_NEAR(fit.C, C, 1e-4);
  }
  double deviation = 0.0;
  constexpr int trials = 200;
  for (unsigned trial = 0; trial < trials; ++trial) {
    const auto fit = fit_beverloo_exponent(points_at(openings, slot, 0.01, 10 + trial), slot);
    deviation += std::pow((fit.exponent - 1.5) / fit.standard_errors[2], 2) / trials;
  }
  EXPECT_NEAR(deviation, 1.0, 0.35);
}

TEST(Beverloo, ExponentAtAGivenK) {
  const auto points = points_at({6.0, 8.0, 12.0}, slot, 0.0, 1);
  const auto fit = fit_beverloo_exponent(points, slot, k);
  EXPECT_NEAR(fit.exponent, 1.5, 1e-6);
  EXPECT_NEAR(fit.C, C, 1e-6);
  EXPECT_EQ(fit.k, k);
  EXPECT_EQ(fit.standard_errors[1], 0.0);
  EXPECT_GT(fit.standard_errors[2], 0.0);
  // A power law of 2 in D itself.
  std::vector<DischargePoint> square;
  for (const double opening : {6.0, 8.0, 12.0}) square.push_back({opening * d, opening * opening, 0.01});
  EXPECT_NEAR(fit_beverloo_exponent(square, slot, 0.0).exponent, 2.0, 1e-6);
  EXPECT_THROW(fit_beverloo_exponent(points, slot), FitError);  // three points
  EXPECT_THROW(fit_beverloo_exponent(points, slot, 6.5), FitError);
}

TEST(Beverloo, PointsThatHaveNoLaw) {
  EXPECT_THROW(fit_beverloo({}, slot), FitError);
  EXPECT_THROW(fit_beverloo(points_at({8.0, 8.0, 8.0}, slot, 0.01, 1), slot), FitError);
  auto broken = points_at(openings, slot, 0.0, 1);
  broken[1].rate = 0.0;
  EXPECT_THROW(fit_beverloo(broken, slot), FitError);
  broken = points_at(openings, slot, 0.0, 1);
  broken[1].standard_error = 0.0;
  EXPECT_THROW(fit_beverloo(broken, slot), FitError);
  auto falling = points_at(openings, slot, 0.0, 1);
  for (std::size_t p = 0; p < falling.size(); ++p) falling[p].rate = 1.0 / static_cast<double>(p + 1);
  EXPECT_THROW(fit_beverloo(falling, slot), FitError);
}

TEST(Beverloo, BrokenOrifice) {
  Orifice broken = slot;
  broken.grain_diameter = 0.0;
  EXPECT_THROW(fit_beverloo(points_at(openings, slot, 0.0, 1), broken), std::invalid_argument);
  EXPECT_THROW(beverloo_rate(1.0, broken, C, k), std::invalid_argument);
}

}  // namespace
}  // namespace talus::analysis
