#include "analysis/statistics/mu_of_i.h"

#include <fmt/format.h>
#include <gsl/gsl_fit.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <set>
#include <vector>

#include "analysis/statistics/fit_error.h"
#include "analysis/statistics/nonlinear_fit.h"

namespace talus::analysis {
namespace {

constexpr double most_open = 1.0;  // standard error of ln I_0

struct Columns {
  std::vector<double> inertial_number, value, sigma;
};

Columns columns_of(std::span<const ShearPoint> points, std::size_t least_different) {
  Columns columns;
  for (const ShearPoint& point : points) {
    if (!(point.inertial_number >= 0.0 && std::isfinite(point.inertial_number) &&
          std::isfinite(point.value) && point.standard_error > 0.0 && std::isfinite(point.standard_error))) {
      throw FitError(
          fmt::format("{} +- {} at I = {} is not a finite value with a positive standard error at I >= 0",
                      point.value, point.standard_error, point.inertial_number));
    }
    columns.inertial_number.push_back(point.inertial_number);
    columns.value.push_back(point.value);
    columns.sigma.push_back(point.standard_error);
  }
  const std::set<double> different(columns.inertial_number.begin(), columns.inertial_number.end());
  if (different.size() < least_different) {
    throw FitError(fmt::format("{} different I, but {} are needed", different.size(), least_different));
  }
  return columns;
}

/// How far the law has gone from mu_1 to mu_2.
double progress(double inertial_number, double I_0) { return inertial_number / (inertial_number + I_0); }

/// mu_1, mu_2 and ln I_0: for each I_0 of a ladder the other two follow linearly; the best step of it.
Eigen::Vector3d start_of(const Columns& columns) {
  const auto rows = static_cast<Eigen::Index>(columns.value.size());
  const auto map = [&](const std::vector<double>& column) {
    return Eigen::Map<const Eigen::ArrayXd>(column.data(), rows);
  };
  const Eigen::ArrayXd weight = map(columns.sigma).inverse();
  const Eigen::ArrayXd inertial_number = map(columns.inertial_number);
  const Eigen::VectorXd right = map(columns.value) * weight;
  const double least = (inertial_number > 0.0).select(inertial_number, inertial_number.maxCoeff()).minCoeff();
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  double best_residual = std::numeric_limits<double>::infinity();
  double I_0 = 0.1 * least;
  while (I_0 < 20.0 * inertial_number.maxCoeff()) {
    Eigen::MatrixX2d left(rows, 2);
    const Eigen::ArrayXd gone = inertial_number / (inertial_number + I_0);
    left.col(0) = (1.0 - gone) * weight;
    left.col(1) = gone * weight;
    const Eigen::Vector2d mu = left.colPivHouseholderQr().solve(right);
    const double residual = (left * mu - right).squaredNorm();
    if (residual < best_residual) {
      best_residual = residual;
      best << mu, std::log(I_0);
    }
    I_0 *= 1.5;
  }
  return best;
}

}  // namespace

FrictionLawFit fit_friction_law(std::span<const ShearPoint> points) {
  const Columns columns = columns_of(points, 3);
  // ln I_0 rather than I_0, which then cannot turn negative on the way.
  const auto law = [&](std::size_t point, const Eigen::VectorXd& p) {
    return p[0] + (p[1] - p[0]) * progress(columns.inertial_number[point], std::exp(p[2]));
  };
  const NonlinearFit fit = fit_nonlinear(law, columns.value, columns.sigma, start_of(columns));
  const double open = std::sqrt(fit.covariance(2, 2));
  if (fit.parameters[1] <= fit.parameters[0]) {
    throw FitError(fmt::format("mu does not grow with I: mu_1 = {:.4g}, mu_2 = {:.4g}", fit.parameters[0],
                               fit.parameters[1]));
  }
  if (!(open <= most_open)) {
    throw FitError(
        fmt::format("the points leave I_0 open: ln I_0 = {:.3g} +- {:.3g}", fit.parameters[2], open));
  }
  const double I_0 = std::exp(fit.parameters[2]);
  const Eigen::Vector3d scale(1.0, 1.0, I_0);
  const Eigen::Matrix3d covariance = scale.asDiagonal() * fit.covariance * scale.asDiagonal();
  return {.mu_1 = fit.parameters[0],
          .mu_2 = fit.parameters[1],
          .I_0 = I_0,
          .standard_errors = covariance.diagonal().cwiseSqrt(),
          .covariance = covariance,
          .reduced_chi_squared = fit.reduced_chi_squared()};
}

VolumeFractionFit fit_volume_fraction(std::span<const ShearPoint> points) {
  const Columns columns = columns_of(points, 2);
  std::vector<double> weights;
  for (const double sigma : columns.sigma) weights.push_back(1.0 / (sigma * sigma));
  double intercept, slope, variance_intercept, covariance, variance_slope, chi_squared;
  gsl_fit_wlinear(columns.inertial_number.data(), 1, weights.data(), 1, columns.value.data(), 1,
                  weights.size(), &intercept, &slope, &variance_intercept, &covariance, &variance_slope,
                  &chi_squared);
  VolumeFractionFit fit{
      .phi_c = intercept, .b = -slope, .standard_errors = {}, .covariance = {}, .reduced_chi_squared = {}};
  fit.covariance << variance_intercept, -covariance, -covariance, variance_slope;
  fit.standard_errors = fit.covariance.diagonal().cwiseSqrt();
  fit.reduced_chi_squared = weights.size() > 2 ? chi_squared / static_cast<double>(weights.size() - 2)
                                               : std::numeric_limits<double>::quiet_NaN();
  return fit;
}

}  // namespace talus::analysis
