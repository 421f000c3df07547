// Whether two means are the same for all practical purposes, by two one-sided tests (Schuirmann 1987). What must be shown is
// that they agree, so the hypothesis to be rejected is that they do not:
//
//   H_0: |m - r| >= band    against    |m - r| < band
//   t_low = (m - r + band) / u,   t_high = (band - (m - r)) / u,   p = the larger of P(T > t_low), P(T > t_high),  T ~ t_nu
//
// Equivalent when p < alpha, which is when the interval m - r +- t_{nu, alpha} u lies within the band. Few or scattered
// runs make u large and equivalence hard to show: not to have shown it is no proof of a difference.
#pragma once

namespace talus::analysis {

struct Equivalence {
  double p;
  bool equivalent;
};

inline constexpr double equivalence_level = 0.05;  // alpha of each one-sided test

/// `difference` = m - r with its standard uncertainty u, and `band`, all in one unit; `degrees_of_freedom` of u, which may be
/// infinite where u is known. Without uncertainty p is 0 within the band and 1 outside. Throws std::invalid_argument for a
/// difference that is not finite, an uncertainty that is negative or not finite, and a band or degrees of freedom that are
/// not positive.
Equivalence test_equivalence(double difference, double standard_uncertainty, double degrees_of_freedom,
                             double band, double level = equivalence_level);

}  // namespace talus::analysis
