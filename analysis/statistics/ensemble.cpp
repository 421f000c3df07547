#include "analysis/statistics/ensemble.h"

#include <gsl/gsl_statistics_double.h>

#include <limits>
#include <stdexcept>

namespace talus::analysis {

EnsembleStatistics ensemble_statistics(std::span<const double> values) {
  if (values.empty()) throw std::invalid_argument("ensemble_statistics: no members");
  const double mean = gsl_stats_mean(values.data(), 1, values.size());
  const double deviation = values.size() > 1 ? gsl_stats_sd_m(values.data(), 1, values.size(), mean)
                                             : std::numeric_limits<double>::quiet_NaN();
  return {.count = values.size(), .mean = mean, .standard_deviation = deviation};
}

}  // namespace talus::analysis
