// A straight line through points of which a few may lie far off: Cauchy's weights 1 / (1 + (r / 2.385 s)^2), s from the
// median absolute residual, iterated (Holland & Welsch 1977; GSL multifit robust). Not Tukey's bisquare, which throws far
// points out altogether: on 8 points its iteration went round in circles in one fit of 50 to 100, Cauchy's in none of 16000.
#pragma once

#include <span>

namespace talus::analysis {

struct RobustLine {
  double intercept, slope;  // y = intercept + slope x
  double slope_standard_error;
};

/// Throws std::invalid_argument for unequal sizes; FitError for fewer than three points, values that are not finite, fewer than
/// two different x, or an iteration that does not settle.
RobustLine fit_robust_line(std::span<const double> x, std::span<const double> y);

}  // namespace talus::analysis
