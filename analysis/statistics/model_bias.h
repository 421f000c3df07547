// How far off a model is as a whole, over all points at which an observable was compared with its reference, in the manner of
// the FDS Validation Guide (NIST SP 1018-3, "Quantifying Model Uncertainty") and NUREG-1824 Supplement 1:
//
//   E ~ N(theta, (sigma_E theta)^2)               the reference scatters about the truth, without bias
//   M ~ N(delta theta, (sigma_M delta theta)^2)   so does the model, but for the bias factor delta
//   y_i = ln(M_i / E_i),   s^2 = sum (y_i - mean y)^2 / (n - 1) ~ sigma_M^2 + sigma_E^2
//   sigma_M^2 = s^2 - sigma_E^2,   delta = exp(mean y + sigma_M^2 / 2 - sigma_E^2 / 2)
//
// As in the Guide sigma_E^2 is at most s^2 / 2: a model cannot be shown to be better than what it is compared with. The Guide's
// weights by bins are not used: points here are few.
//
// Confidence intervals are not in the Guide. Without the cap ln delta = mean y + s^2 / 2 - sigma_E^2, sigma_E being known:
//   ln delta    +- t_{n-1} sqrt(s^2 / n + s^4 / (2 (n - 1)))     (Cox's method with t, Olsson 2005); with it, s^2 / n alone
//   sigma_M^2   (n - 1) s^2 / chi^2_{n-1} - sigma_E^2            at both tails; 0 where the reference's scatter could be all
#pragma once

#include <optional>
#include <span>
#include <string>

namespace talus::analysis {

/// Of one point, in the same unit.
struct ModelPair {
  double model;
  double reference;
};

struct Interval {
  double lower, upper;
};

struct ModelBias {
  double bias_factor;  // delta
  Interval bias_interval;
  double model_deviation;  // sigma_M, relative
  Interval model_deviation_interval;
  double reference_deviation;  // sigma_E as used
  bool reference_capped;       // sigma_E was given larger, and cut to s / sqrt 2
};

/// One of the two.
struct ModelBiasResult {
  std::optional<ModelBias> found;
  std::string why_not;
};

/// Points that a spread needs to mean something: with two, its 95 % interval ends at 32 times the spread.
inline constexpr std::size_t fewest_bias_points = 3;

/// `reference_deviation` is sigma_E, the relative standard uncertainty of the reference; where it differs from point to
/// point, its root mean square. Tells why there is no answer for fewer than fewest_bias_points, and for a value that is not
/// finite and positive, of which ln does not exist. Throws std::invalid_argument for a reference_deviation that is not finite
/// and at least 0, and a confidence not between 0 and 1.
ModelBiasResult model_bias(std::span<const ModelPair> pairs, double reference_deviation,
                           double confidence = 0.95);

}  // namespace talus::analysis
