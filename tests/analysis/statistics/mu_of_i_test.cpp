#include "analysis/statistics/mu_of_i.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <vector>

#include "analysis/statistics/fit_error.h"

namespace talus::analysis {
namespace {

constexpr double mu_1 = 0.38, mu_2 = 0.64, I_0 = 0.279;

double friction(double I) { return mu_1 + (mu_2 - mu_1) / (1.0 + I_0 / I); }

std::vector<ShearPoint> points_at(const std::vector<double>& numbers, double noise, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<ShearPoint> points;
  for (const double I : numbers) {
    const double sigma = noise * (1.0 + I);  // not all alike
    points.push_back({I, friction(I) + sigma * normal(generator), sigma});
  }
  return points;
}

const std::vector<double> numbers{0.001, 0.003, 0.01, 0.03, 0.06, 0.1, 0.2, 0.3};

std::vector<ShearPoint> exact(const std::vector<double>& at) {
  auto points = points_at(at, 0.0, 1);
  for (auto& point : points) point.standard_error = 0.003;
  return points;
}

TEST(FrictionLaw, ExactPoints) {
  const auto fit = fit_friction_law(exact(numbers));
  EXPECT_NEAR(fit.mu_1, mu_1, 1e-6);
  EXPECT_NEAR(fit.mu_2, mu_2, 1e-5);
  EXPECT_NEAR(fit.I_0, I_0, 1e-5);
  EXPECT_NEAR(fit.reduced_chi_squared, 0.0, 1e-9);
  EXPECT_DOUBLE_EQ(fit.standard_errors[2], std::sqrt(fit.covariance(2, 2)));
}

/// The distance of the fit from the truth, measured in its own covariance, is chi^2 with three degrees of freedom.
TEST(FrictionLaw, CovarianceIsThatOfTheFits) {
  constexpr int trials = 500;
  double distance = 0.0, reduced = 0.0, squared_mu_1 = 0.0;
  for (unsigned trial = 0; trial < trials; ++trial) {
    const auto fit = fit_friction_law(points_at(numbers, 0.001, 10 + trial));
    const Eigen::Vector3d error(fit.mu_1 - mu_1, fit.mu_2 - mu_2, fit.I_0 - I_0);
    distance += error.dot(fit.covariance.inverse() * error) / trials;
    reduced += fit.reduced_chi_squared / trials;
    squared_mu_1 += std::pow(error[0] / fit.standard_errors[0], 2) / trials;
  }
  EXPECT_NEAR(distance, 3.0, 0.5);       // +- sqrt(6/500) = 0.11, and the law is not linear
  EXPECT_NEAR(reduced, 1.0, 0.1);        // +- sqrt(2/5/500) = 0.03
  EXPECT_NEAR(squared_mu_1, 1.0, 0.25);  // +- 0.06
}

TEST(FrictionLaw, PrecisePointsWeighMore) {
  auto points = exact(numbers);
  points.push_back({0.05, 0.9, 10.0});  // far off, and known to be vague
  EXPECT_NEAR(fit_friction_law(points).mu_1, mu_1, 1e-4);
}

TEST(FrictionLaw, ZeroRateIsAPoint) {
  auto points = exact(numbers);
  points.push_back({0.0, mu_1, 0.003});
  EXPECT_NEAR(fit_friction_law(points).mu_1, mu_1, 1e-6);
}

TEST(FrictionLaw, ThreePointsLeaveNoChiSquared) {
  const auto fit = fit_friction_law(exact({0.001, 0.1, 0.4}));
  EXPECT_NEAR(fit.I_0, I_0, 1e-4);
  EXPECT_TRUE(std::isnan(fit.reduced_chi_squared));
}

TEST(FrictionLaw, UndeterminedByThePoints) {
  EXPECT_THROW(fit_friction_law({}), FitError);
  EXPECT_THROW(fit_friction_law(exact({0.01, 0.01, 0.1, 0.1})), FitError);         // two different I
  EXPECT_THROW(fit_friction_law(exact({1e-5, 2e-5, 5e-5, 1e-4})), FitError);       // all far below I_0
  EXPECT_THROW(fit_friction_law(exact({100.0, 200.0, 500.0, 1000.0})), FitError);  // all far above
  auto flat = exact(numbers);
  for (auto& point : flat) point.value = 0.4;
  EXPECT_THROW(fit_friction_law(flat), FitError);
  auto falling = exact(numbers);
  for (auto& point : falling) point.value = 1.0 - point.value;
  EXPECT_THROW(fit_friction_law(falling), FitError);
  auto broken = exact(numbers);
  broken[2].standard_error = 0.0;
  EXPECT_THROW(fit_friction_law(broken), FitError);
  broken = exact(numbers);
  broken[2].inertial_number = -0.1;
  EXPECT_THROW(fit_friction_law(broken), FitError);
}

TEST(VolumeFraction, WeightedLine) {
  const std::vector<ShearPoint> points{{0.0, 0.60, 0.001}, {0.1, 0.58, 0.001}, {0.2, 0.56, 0.002}};
  const auto fit = fit_volume_fraction(points);
  EXPECT_NEAR(fit.phi_c, 0.60, 1e-12);
  EXPECT_NEAR(fit.b, 0.2, 1e-12);
  EXPECT_NEAR(fit.reduced_chi_squared, 0.0, 1e-12);
  // (A^T W A)^-1 with W = 1e6 (1, 1, 1/4): A^T W A = 1e6 (2.25, .15; .15, .02), and b has the other sign.
  EXPECT_NEAR(fit.covariance(0, 0), 1e-6 * 0.02 / 0.0225, 1e-12);
  EXPECT_NEAR(fit.covariance(1, 1), 1e-6 * 2.25 / 0.0225, 1e-10);
  EXPECT_NEAR(fit.covariance(0, 1), 1e-6 * 0.15 / 0.0225, 1e-11);
}

TEST(VolumeFraction, UndeterminedByThePoints) {
  EXPECT_THROW(fit_volume_fraction(std::vector<ShearPoint>{{0.1, 0.6, 0.01}, {0.1, 0.5, 0.01}}), FitError);
  EXPECT_THROW(fit_volume_fraction(std::vector<ShearPoint>{{0.1, NAN, 0.01}, {0.2, 0.5, 0.01}}), FitError);
  EXPECT_TRUE(std::isnan(
      fit_volume_fraction(std::vector<ShearPoint>{{0.1, 0.6, 0.01}, {0.2, 0.5, 0.01}}).reduced_chi_squared));
}

}  // namespace
}  // namespace talus::analysis
