#include "analysis/statistics/nonlinear_fit.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "analysis/statistics/fit_error.h"

namespace talus::analysis {
namespace {

const std::vector<double> x{0.0, 1.0, 2.0, 4.0};
const std::vector<double> sigma{0.1, 0.2, 0.1, 0.4};

double line(std::size_t point, const Eigen::VectorXd& p) { return p[0] + p[1] * x[point]; }

TEST(NonlinearFit, AStraightLineIsThatOfTheNormalEquations) {
  const std::vector<double> y{1.0, 2.5, 2.0, 6.0};
  Eigen::MatrixX2d left(4, 2);
  Eigen::VectorXd right(4);
  for (int k = 0; k < 4; ++k) {
    left.row(k) << 1.0 / sigma[k], x[k] / sigma[k];
    right[k] = y[k] / sigma[k];
  }
  const Eigen::Matrix2d covariance = (left.transpose() * left).inverse();
  const Eigen::Vector2d expected = covariance * left.transpose() * right;
  const auto fit = fit_nonlinear(line, y, sigma, Eigen::Vector2d(10.0, -3.0));
  EXPECT_TRUE(fit.parameters.isApprox(expected, 1e-8));
  EXPECT_TRUE(fit.covariance.isApprox(covariance, 1e-6));
  EXPECT_NEAR(fit.chi_squared, (left * expected - right).squaredNorm(), 1e-8);
  EXPECT_EQ(fit.degrees_of_freedom, 2u);
  EXPECT_DOUBLE_EQ(fit.reduced_chi_squared(), fit.chi_squared / 2.0);
}

TEST(NonlinearFit, AnExactStartStaysWhereItIs) {
  const std::vector<double> y{1.0, 3.0, 5.0, 9.0};
  const auto fit = fit_nonlinear(line, y, sigma, Eigen::Vector2d(1.0, 2.0));
  EXPECT_NEAR(fit.parameters[0], 1.0, 1e-12);
  EXPECT_NEAR(fit.parameters[1], 2.0, 1e-12);
  EXPECT_NEAR(fit.chi_squared, 0.0, 1e-12);
}

TEST(NonlinearFit, UnitsDoNotMatter) {
  const std::vector<double> y{1.0, 2.5, 2.0, 6.0};
  const auto tiny = [](std::size_t point, const Eigen::VectorXd& p) { return p[0] + 1e9 * p[1] * x[point]; };
  const auto fit = fit_nonlinear(tiny, y, sigma, Eigen::Vector2d(0.5, 0.5e-9));
  const auto expected = fit_nonlinear(line, y, sigma, Eigen::Vector2d(0.5, 0.5));
  EXPECT_NEAR(1e9 * fit.parameters[1], expected.parameters[1], 1e-6);
  EXPECT_NEAR(1e18 * fit.covariance(1, 1), expected.covariance(1, 1), 1e-6);
}

TEST(NonlinearFit, PointsThatDetermineNothing) {
  const std::vector<double> y{1.0, 2.5, 2.0, 6.0};
  const Eigen::Vector2d start(1.0, 1.0);
  const auto sum_only = [](std::size_t, const Eigen::VectorXd& p) { return p[0] + p[1]; };
  EXPECT_THROW(fit_nonlinear(sum_only, y, sigma, start), FitError);
  const auto first_only = [](std::size_t, const Eigen::VectorXd& p) { return p[0]; };
  EXPECT_THROW(fit_nonlinear(first_only, y, sigma, start), FitError);
  EXPECT_THROW(fit_nonlinear(line, std::vector{1.0}, std::vector{0.1}, start), FitError);
}

TEST(NonlinearFit, BrokenPoints) {
  const Eigen::Vector2d start(1.0, 1.0);
  const std::vector<double> y{1.0, 2.5, 2.0, 6.0};
  EXPECT_THROW(fit_nonlinear(line, y, std::vector{0.1, 0.1, 0.1, 0.0}, start), FitError);
  EXPECT_THROW(fit_nonlinear(line, std::vector<double>{1.0, NAN, 2.0, 6.0}, sigma, start), FitError);
  EXPECT_THROW(fit_nonlinear(line, y, std::vector{0.1}, start), std::invalid_argument);
  const auto undefined = [](std::size_t, const Eigen::VectorXd&) { return NAN; };
  EXPECT_THROW(fit_nonlinear(undefined, y, sigma, start), FitError);
}

}  // namespace
}  // namespace talus::analysis
