#include "analysis/statistics/beverloo.h"

#include <fmt/format.h>
#include <gsl/gsl_fit.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <stdexcept>
#include <vector>

#include "analysis/statistics/fit_error.h"
#include "analysis/statistics/nonlinear_fit.h"

namespace talus::analysis {
namespace {

double own_exponent(const Orifice& orifice) { return orifice.slot_depth ? 1.5 : 2.5; }

/// The rate of C = 1 at D - k d = d.
double rate_scale(const Orifice& orifice) {
  return orifice.bulk_density * std::sqrt(orifice.gravity) * orifice.slot_depth.value_or(1.0) *
         std::pow(orifice.grain_diameter, own_exponent(orifice));
}

/// (D - k d) / d, at least 0.
double passage(double opening, const Orifice& orifice, double k) {
  return std::max(0.0, opening / orifice.grain_diameter - k);
}

void check_orifice(const Orifice& orifice) {
  for (const double value :
       {orifice.grain_diameter, orifice.bulk_density, orifice.gravity, orifice.slot_depth.value_or(1.0)}) {
    if (value > 0.0 && std::isfinite(value)) continue;
    throw std::invalid_argument(fmt::format("Orifice: {} where a positive number is needed", value));
  }
}

/// The points as columns, the rates over the scale, so that parameters and residuals are all about 1.
struct Columns {
  std::vector<double> opening, rate, sigma;
};

Columns columns_of(std::span<const DischargePoint> points, const Orifice& orifice,
                   std::size_t least_different) {
  check_orifice(orifice);
  Columns columns;
  const double scale = rate_scale(orifice);
  for (const DischargePoint& point : points) {
    for (const double value : {point.opening, point.rate, point.standard_error}) {
      if (value > 0.0 && std::isfinite(value)) continue;
      throw FitError(fmt::format("the point W = {} +- {} kg/s at D = {} m is not finite and positive",
                                 point.rate, point.standard_error, point.opening));
    }
    columns.opening.push_back(point.opening);
    columns.rate.push_back(point.rate / scale);
    columns.sigma.push_back(point.standard_error / scale);
  }
  const std::set<double> different(columns.opening.begin(), columns.opening.end());
  if (different.size() < least_different) {
    throw FitError(
        fmt::format("{} different openings, but {} are needed", different.size(), least_different));
  }
  return columns;
}

double least_opening(const Columns& columns, const Orifice& orifice) {
  return *std::ranges::min_element(columns.opening) / orifice.grain_diameter;
}

/// C and k from the straight line of W^(1/n) against D, each point weighed as its sigma there; k short of the least opening.
Eigen::Vector2d start_of(const Columns& columns, const Orifice& orifice) {
  const double power = 1.0 / own_exponent(orifice);
  std::vector<double> across, root, weight;
  for (std::size_t point = 0; point < columns.rate.size(); ++point) {
    across.push_back(columns.opening[point] / orifice.grain_diameter);
    root.push_back(std::pow(columns.rate[point], power));
    weight.push_back(std::pow(columns.rate[point] / (power * root.back() * columns.sigma[point]), 2));
  }
  double intercept, slope, variance0, covariance, variance1, chi_squared;
  gsl_fit_wlinear(across.data(), 1, weight.data(), 1, root.data(), 1, across.size(), &intercept, &slope,
                  &variance0, &covariance, &variance1, &chi_squared);
  if (!(slope > 0.0)) throw FitError("the rate does not grow with the opening");
  return {std::pow(slope, own_exponent(orifice)),
          std::min(-intercept / slope, 0.95 * least_opening(columns, orifice))};
}

void require_open(double C, double k, const Columns& columns, const Orifice& orifice) {
  if (!(C > 0.0)) throw FitError(fmt::format("the fitted C = {:.4g} is not positive", C));
  if (k < least_opening(columns, orifice)) return;
  throw FitError(fmt::format("k = {:.4g} closes the smallest opening, of {:.4g} d, though it has a rate", k,
                             least_opening(columns, orifice)));
}

/// The exponent and C at this k, k itself (index 1) as well when `k_is_free`.
NonlinearFit fit_exponent(const Columns& columns, const Orifice& orifice, const Eigen::Vector2d& start,
                          bool k_is_free) {
  const auto law = [&](std::size_t point, const Eigen::VectorXd& p) {
    return p[0] * std::pow(passage(columns.opening[point], orifice, k_is_free ? p[2] : start[1]), p[1]);
  };
  Eigen::VectorXd from(k_is_free ? 3 : 2);
  from.head<2>() << start[0], own_exponent(orifice);
  if (k_is_free) from[2] = start[1];
  return fit_nonlinear(law, columns.rate, columns.sigma, from);
}

}  // namespace

double beverloo_rate(double opening, const Orifice& orifice, double C, double k) {
  check_orifice(orifice);
  return C * rate_scale(orifice) * std::pow(passage(opening, orifice, k), own_exponent(orifice));
}

BeverlooFit fit_beverloo(std::span<const DischargePoint> points, const Orifice& orifice) {
  const Columns columns = columns_of(points, orifice, 2);
  const auto law = [&](std::size_t point, const Eigen::VectorXd& p) {
    return p[0] * std::pow(passage(columns.opening[point], orifice, p[1]), own_exponent(orifice));
  };
  const NonlinearFit fit = fit_nonlinear(law, columns.rate, columns.sigma, start_of(columns, orifice));
  require_open(fit.parameters[0], fit.parameters[1], columns, orifice);
  return {.C = fit.parameters[0],
          .k = fit.parameters[1],
          .standard_errors = fit.covariance.diagonal().cwiseSqrt(),
          .covariance = fit.covariance,
          .chi_squared = fit.chi_squared,
          .reduced_chi_squared = fit.reduced_chi_squared()};
}

BeverlooExponentFit fit_beverloo_exponent(std::span<const DischargePoint> points, const Orifice& orifice,
                                          std::optional<double> given_k) {
  const Columns columns = columns_of(points, orifice, given_k ? 2 : 4);
  Eigen::Vector2d start = start_of(columns, orifice);
  if (given_k) {
    if (!std::isfinite(*given_k))
      throw std::invalid_argument("fit_beverloo_exponent: the given k is not finite");
    start[1] = *given_k;
    require_open(start[0], start[1], columns, orifice);
  }
  const NonlinearFit fit = fit_exponent(columns, orifice, start, !given_k);
  const double k = given_k ? *given_k : fit.parameters[2];
  require_open(fit.parameters[0], k, columns, orifice);
  // From the order of the fit (C, exponent, k) to that of the result; a given k has no variance.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  const std::vector<int> order = given_k ? std::vector{0, 2} : std::vector{0, 2, 1};
  covariance(order, order) = fit.covariance;
  return {.C = fit.parameters[0],
          .k = k,
          .exponent = fit.parameters[1],
          .standard_errors = covariance.diagonal().cwiseSqrt(),
          .covariance = covariance,
          .chi_squared = fit.chi_squared,
          .reduced_chi_squared = fit.reduced_chi_squared()};
}

}  // namespace talus::analysis
