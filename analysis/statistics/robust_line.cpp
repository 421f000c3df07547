#include "analysis/statistics/robust_line.h"

#include <gsl/gsl_multifit.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "analysis/statistics/gsl_call.h"

namespace talus::analysis {
namespace {

constexpr std::size_t parameters = 2;
constexpr std::size_t most_iterations = 1000;

void check_points(std::span<const double> x, std::span<const double> y) {
  if (x.size() != y.size()) throw std::invalid_argument("fit_robust_line: as many x as y are needed");
  if (x.size() <= parameters) throw FitError("robust line: at least three points are needed");
  const auto is_finite = [](double value) { return std::isfinite(value); };
  if (!std::ranges::all_of(x, is_finite) || !std::ranges::all_of(y, is_finite)) {
    throw FitError("robust line: a value is not finite");
  }
  if (std::ranges::all_of(x, [&](double value) { return value == x.front(); })) {
    throw FitError("robust line: all x are the same");
  }
}

}  // namespace

RobustLine fit_robust_line(std::span<const double> x, std::span<const double> y) {
  check_points(x, y);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, parameters, Eigen::RowMajor>;
  RowMajor design(static_cast<Eigen::Index>(x.size()), 2);
  design.col(0).setOnes();
  design.col(1) = Eigen::Map<const Eigen::VectorXd>(x.data(), design.rows());
  const auto design_view = gsl_matrix_const_view_array(design.data(), x.size(), parameters);
  const auto y_view = gsl_vector_const_view_array(y.data(), y.size());

  const GslErrorsReturned errors;
  const std::unique_ptr<gsl_multifit_robust_workspace, decltype(&gsl_multifit_robust_free)> workspace(
      gsl_multifit_robust_alloc(gsl_multifit_robust_cauchy, x.size(), parameters), &gsl_multifit_robust_free);
  if (!workspace) throw std::bad_alloc();
  require_gsl(gsl_multifit_robust_maxiter(most_iterations, workspace.get()), "robust line");
  Eigen::Vector2d line;
  Eigen::Matrix2d covariance;
  auto line_view = gsl_vector_view_array(line.data(), parameters);
  auto covariance_view = gsl_matrix_view_array(covariance.data(), parameters, parameters);
  require_gsl(gsl_multifit_robust(&design_view.matrix, &y_view.vector, &line_view.vector,
                                  &covariance_view.matrix, workspace.get()),
              "robust line");
  return {line[0], line[1], std::sqrt(covariance(1, 1))};
}

}  // namespace talus::analysis
