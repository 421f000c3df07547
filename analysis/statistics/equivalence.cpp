#include "analysis/statistics/equivalence.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace talus::analysis {
namespace {

void require(bool holds, const char* what, double value) {
  if (!holds) throw std::invalid_argument(fmt::format("test_equivalence: {} of {}", what, value));
}

/// P(T > t).
double upper_tail(double t, double degrees_of_freedom) {
  return std::isinf(degrees_of_freedom) ? gsl_cdf_ugaussian_Q(t) : gsl_cdf_tdist_Q(t, degrees_of_freedom);
}

}  // namespace

Equivalence test_equivalence(double difference, double standard_uncertainty, double degrees_of_freedom,
                             double band, double level) {
  require(std::isfinite(difference), "a difference", difference);
  require(standard_uncertainty >= 0.0 && std::isfinite(standard_uncertainty), "an uncertainty",
          standard_uncertainty);
  require(degrees_of_freedom > 0.0, "degrees of freedom", degrees_of_freedom);
  require(band > 0.0 && std::isfinite(band), "a band", band);
  require(level > 0.0 && level < 1.0, "a level", level);
  const double margin = band - std::abs(difference);  // of the nearer side, whose test decides
  if (standard_uncertainty == 0.0) return {margin > 0.0 ? 0.0 : 1.0, margin > 0.0};
  const double p = upper_tail(margin / standard_uncertainty, degrees_of_freedom);
  return {p, p < level};
}

}  // namespace talus::analysis
