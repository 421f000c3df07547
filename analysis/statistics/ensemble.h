// Mean and spread of an observable over seeds.
#pragma once

#include <cstddef>
#include <span>

namespace talus::analysis {

struct EnsembleStatistics {
  std::size_t count;
  double mean;
  double standard_deviation;  // of one member, n - 1 in the denominator; NaN for a single member
};

/// Throws std::invalid_argument for an empty ensemble.
EnsembleStatistics ensemble_statistics(std::span<const double> values);

}  // namespace talus::analysis
