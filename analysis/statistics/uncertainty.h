// What the reference value of an observable is worth, from the runs of one or more discrete codes with several seeds each.
//
//   value      mean of the codes' means: no code is the truth, and more seeds do not make one more right
//   seeds      s^2 = sum over codes (n_k - 1) s_k^2 / sum (n_k - 1), the deviation of one run, taken to be the same in all
//              codes; u_seed = s sqrt(sum 1/n_k) / m for m codes, the standard error of the value
//   codes      D = largest less smallest mean. The truth is taken to lie anywhere between them with equal likelihood:
//              half-width D/2, so u_code = D / 2 / sqrt(3) (GUM 4.3.7). D also holds what the seeds make of it, so with few
//              seeds u_code is rather too large than too small.
//   measuring  u_measure, given: coarse-graining, bins, thresholds
//   combined   u_c = sqrt(u_seed^2 + u_code^2 + u_measure^2) (GUM 5.1.2)
//
// What the runs cannot tell is absent, not zero: with one seed a code there is no s, with one code no D.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/statistics/ensemble.h"

namespace talus::analysis {

struct CodeValues {
  std::string code;            // liggghts, yade
  std::vector<double> values;  // one a seed
};

struct CodeSummary {
  std::string code;
  EnsembleStatistics statistics;         // its standard deviation is NaN for one seed
  std::optional<double> standard_error;  // of the mean, from the code's own seeds; absent for one seed
};

struct Uncertainty {
  std::vector<CodeSummary> codes;  // in the order given
  double value;
  std::optional<double> seed_deviation;   // s, of one run; absent when no code has two seeds
  int seed_degrees_of_freedom;            // of s: sum of n_k - 1
  std::optional<double> seed_standard;    // u_seed
  std::optional<double> code_difference;  // D; absent for one code
  std::optional<double> code_standard;    // u_code
  double measurement_standard;            // u_measure
  std::optional<double> combined;         // u_c; absent when u_seed is; for one code it is without u_code
};

/// `measurement_standard` >= 0, in the unit of the values. Throws std::invalid_argument for no codes, a code without values,
/// the same code twice, or a number that is not finite.
Uncertainty combine_uncertainty(std::span<const CodeValues> codes, double measurement_standard);

}  // namespace talus::analysis
