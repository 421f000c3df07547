// The two laws of steady granular shear, fitted to what a shear cell measured at several inertial numbers I
// (GDR MiDi 2004; Jop, Forterre & Pouliquen 2006):
//
//   friction         mu(I)  = mu_1 + (mu_2 - mu_1) / (1 + I_0 / I)
//   volume fraction  phi(I) = phi_c - b I
//
// Standard errors rest on those of the points; a reduced chi^2 well above 1 says that the law, or they, are wrong.
#pragma once

#include <Eigen/Core>
#include <span>

namespace talus::analysis {

struct ShearPoint {
  double inertial_number;  // I >= 0
  double value;            // mu or phi
  double standard_error;   // of the value, positive
};

struct FrictionLawFit {
  double mu_1, mu_2, I_0;
  Eigen::Vector3d standard_errors;  // in this order, as is the covariance
  Eigen::Matrix3d covariance;
  double reduced_chi_squared;  // NaN for three points
};

struct VolumeFractionFit {
  double phi_c, b;
  Eigen::Vector2d standard_errors;  // in this order, as is the covariance
  Eigen::Matrix2d covariance;
  double reduced_chi_squared;  // NaN for two points
};

/// Throws FitError for points that are not finite or whose standard error is not positive; for fewer than three different I;
/// when mu does not grow with I; and when I_0 is left open by more than a factor e (standard error of ln I_0 over 1), as where
/// all points lie far below or far above it.
FrictionLawFit fit_friction_law(std::span<const ShearPoint> points);

/// Throws FitError as above, for fewer than two different I.
VolumeFractionFit fit_volume_fraction(std::span<const ShearPoint> points);

}  // namespace talus::analysis
