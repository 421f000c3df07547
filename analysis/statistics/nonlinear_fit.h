// Weighted least squares for a law with any parameters: minimises chi^2 = sum ((y_i - f_i(p)) / sigma_i)^2 by
// Levenberg-Marquardt (GSL multifit nlinear), central differences for the derivatives.
//
// covariance = (J^T J)^-1, J = (df_i / dp) / sigma_i: it rests on the sigma given and is not scaled by chi^2. Whether the law
// fits at all is told by chi^2 over the degrees of freedom, which is then about 1.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>

namespace talus::analysis {

struct NonlinearFit {
  Eigen::VectorXd parameters;
  Eigen::MatrixXd covariance;
  double chi_squared;
  std::size_t degrees_of_freedom;  // points less parameters

  /// NaN when there are no degrees of freedom left.
  double reduced_chi_squared() const {
    return degrees_of_freedom > 0 ? chi_squared / static_cast<double>(degrees_of_freedom)
                                  : std::numeric_limits<double>::quiet_NaN();
  }
};

/// f_i(p): what the law gives at point i.
using Law = std::function<double(std::size_t point, const Eigen::VectorXd& parameters)>;

/// Throws std::invalid_argument for unequal sizes; FitError for fewer points than parameters, a value that is not finite, a
/// sigma that is not positive, parameters that the points leave undetermined, or no minimum found from `start`.
NonlinearFit fit_nonlinear(const Law& law, std::span<const double> values, std::span<const double> sigmas,
                           const Eigen::VectorXd& start);

}  // namespace talus::analysis
