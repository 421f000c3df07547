#include "analysis/statistics/nonlinear_fit.h"

#include <fmt/format.h>
#include <gsl/gsl_multifit_nlinear.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <stdexcept>

#include "analysis/statistics/gsl_call.h"

namespace talus::analysis {
namespace {

constexpr std::size_t most_iterations = 500;
constexpr double parameter_tolerance = 1e-10;  // relative step
constexpr double stationary = 1e-5;            // cosine between the residuals and what a parameter can change
constexpr double least_independence = 1e-12;   // smallest over largest eigenvalue of J^T J, columns scaled

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Workspace = std::unique_ptr<gsl_multifit_nlinear_workspace, decltype(&gsl_multifit_nlinear_free)>;

struct Problem {
  const Law& law;
  std::span<const double> values, sigmas;
};

int residuals(const gsl_vector* parameters, void* context, gsl_vector* result) {
  const auto& problem = *static_cast<const Problem*>(context);
  Eigen::VectorXd at(static_cast<Eigen::Index>(parameters->size));
  for (std::size_t k = 0; k < parameters->size; ++k)
    at[static_cast<Eigen::Index>(k)] = gsl_vector_get(parameters, k);
  for (std::size_t point = 0; point < problem.values.size(); ++point) {
    const double residual = (problem.law(point, at) - problem.values[point]) / problem.sigmas[point];
    if (!std::isfinite(residual)) return GSL_EDOM;
    gsl_vector_set(result, point, residual);
  }
  return GSL_SUCCESS;
}

void check_points(std::span<const double> values, std::span<const double> sigmas, Eigen::Index parameters) {
  if (values.size() != sigmas.size())
    throw std::invalid_argument("fit_nonlinear: one sigma for each value is needed");
  if (values.size() < static_cast<std::size_t>(parameters)) {
    throw FitError(fmt::format("{} points cannot determine {} parameters", values.size(), parameters));
  }
  for (std::size_t point = 0; point < values.size(); ++point) {
    if (std::isfinite(values[point]) && std::isfinite(sigmas[point]) && sigmas[point] > 0.0) continue;
    throw FitError(fmt::format("point {}: {} +- {} is not a finite value with a positive standard error",
                               point, values[point], sigmas[point]));
  }
}

Eigen::VectorXd copy(const gsl_vector& vector) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(vector.size));
  for (std::size_t k = 0; k < vector.size; ++k)
    values[static_cast<Eigen::Index>(k)] = gsl_vector_get(&vector, k);
  return values;
}

RowMajor copy(const gsl_matrix& matrix) {
  return Eigen::Map<const RowMajor, 0, Eigen::OuterStride<>>(
      matrix.data, static_cast<Eigen::Index>(matrix.size1), static_cast<Eigen::Index>(matrix.size2),
      Eigen::OuterStride<>(static_cast<Eigen::Index>(matrix.tda)));
}

/// No parameter can lessen the residuals to first order.
bool is_stationary(const RowMajor& jacobian, const Eigen::VectorXd& residual) {
  const Eigen::VectorXd slope = (jacobian.transpose() * residual).cwiseAbs();
  const Eigen::VectorXd scale = jacobian.colwise().norm() * residual.norm();
  return (slope.array() <= stationary * scale.array() + 1e-12).all();
}

/// (J^T J)^-1, from J with columns scaled to one length, so that units do not matter.
Eigen::MatrixXd covariance_of(const RowMajor& jacobian) {
  const Eigen::RowVectorXd lengths = jacobian.colwise().norm();
  const char* undetermined = "the points leave a parameter, or a combination of them, undetermined";
  if (!(lengths.minCoeff() > 0.0)) throw FitError(undetermined);
  const Eigen::MatrixXd scaled = jacobian.array().rowwise() / lengths.array();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> normal(scaled.transpose() * scaled);
  const Eigen::VectorXd& eigenvalues = normal.eigenvalues();
  if (!(eigenvalues.minCoeff() > least_independence * eigenvalues.maxCoeff())) throw FitError(undetermined);
  const Eigen::MatrixXd& directions = normal.eigenvectors();
  const Eigen::MatrixXd inverse =
      directions * eigenvalues.cwiseInverse().asDiagonal() * directions.transpose();
  return inverse.array() / (lengths.transpose() * lengths).array();
}

}  // namespace

NonlinearFit fit_nonlinear(const Law& law, std::span<const double> values, std::span<const double> sigmas,
                           const Eigen::VectorXd& start) {
  check_points(values, sigmas, start.size());
  Problem problem{law, values, sigmas};
  const auto parameters = static_cast<std::size_t>(start.size());
  gsl_multifit_nlinear_fdf functions{};
  functions.f = residuals;
  functions.n = values.size();
  functions.p = parameters;
  functions.params = &problem;
  auto options = gsl_multifit_nlinear_default_parameters();
  options.fdtype = GSL_MULTIFIT_NLINEAR_CTRDIFF;

  const GslErrorsReturned errors;
  const Workspace workspace(
      gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &options, values.size(), parameters),
      &gsl_multifit_nlinear_free);
  if (!workspace) throw std::bad_alloc();
  const auto start_view = gsl_vector_const_view_array(start.data(), parameters);
  require_gsl(gsl_multifit_nlinear_init(&start_view.vector, &functions, workspace.get()), "nonlinear fit");
  int reason = 0;
  const int status = gsl_multifit_nlinear_driver(most_iterations, parameter_tolerance, parameter_tolerance,
                                                 0.0, nullptr, nullptr, &reason, workspace.get());

  const RowMajor jacobian = copy(*gsl_multifit_nlinear_jac(workspace.get()));
  const Eigen::VectorXd residual = copy(*gsl_multifit_nlinear_residual(workspace.get()));
  // GSL also gives up where round-off leaves nothing to gain, as at an exact start.
  if (status != GSL_SUCCESS && !is_stationary(jacobian, residual)) require_gsl(status, "nonlinear fit");
  return {.parameters = copy(*gsl_multifit_nlinear_position(workspace.get())),
          .covariance = covariance_of(jacobian),
          .chi_squared = residual.squaredNorm(),
          .degrees_of_freedom = values.size() - parameters};
}

}  // namespace talus::analysis
