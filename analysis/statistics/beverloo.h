// Beverloo's law of discharge through an opening D wide (Beverloo, Leniger & van de Velde 1961), fitted to measured rates:
//
//   slot of depth w   W = C rho_b sqrt(g) w (D - k d)^(3/2)
//   round hole        W = C rho_b sqrt(g) (D - k d)^(5/2)
//
// d is the grain diameter, rho_b the bulk density, C and k numbers. Below k d the law lets nothing through. With the exponent n
// free the units are kept by d:  W = C rho_b sqrt(g) w d^(3/2) ((D - k d) / d)^n, and d^(5/2) for the hole: the same C where n
// is the law's own.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

namespace talus::analysis {

struct DischargePoint {
  double opening;         // D, m
  double rate;            // W, kg/s
  double standard_error;  // of the rate, kg/s, positive
};

struct Orifice {
  double grain_diameter;                  // d, m
  double bulk_density;                    // rho_b, kg/m^3
  double gravity = 9.81;                  // g, m/s^2
  std::optional<double> slot_depth = {};  // w, m; absent for a round hole
};

struct BeverlooFit {
  double C, k;
  Eigen::Vector2d standard_errors;  // of C and k
  Eigen::Matrix2d covariance;
  double chi_squared;
  double reduced_chi_squared;  // NaN for two points
};

struct BeverlooExponentFit {
  double C, k, exponent;
  Eigen::Vector3d standard_errors;  // of C, k and the exponent; zero for a k that was given
  Eigen::Matrix3d covariance;
  double chi_squared;
  double reduced_chi_squared;  // NaN when as many points as parameters
};

/// W of the law, kg/s; zero where D <= k d.
double beverloo_rate(double opening, const Orifice& orifice, double C, double k);

/// Throws std::invalid_argument for a broken orifice; FitError for fewer than two different openings, points that are not
/// finite and positive, or when C or a D - k d of the fit is not positive.
BeverlooFit fit_beverloo(std::span<const DischargePoint> points, const Orifice& orifice);

/// The exponent as well. With `given_k` only C and the exponent are fitted, which needs two different openings; without, four.
/// Throws as fit_beverloo, and FitError for a given k that closes an opening.
BeverlooExponentFit fit_beverloo_exponent(std::span<const DischargePoint> points, const Orifice& orifice,
                                          std::optional<double> given_k = {});

}  // namespace talus::analysis
