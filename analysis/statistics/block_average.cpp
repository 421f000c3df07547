#include "analysis/statistics/block_average.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/statistics/ensemble.h"
#include "analysis/statistics/fit_error.h"

namespace talus::analysis {
namespace {

constexpr std::size_t least_blocks = 8;  // which know their own scatter within 27 %

/// Standard error of the mean, were the values independent.
double independent_error(std::span<const double> values) {
  return ensemble_statistics(values).standard_deviation / std::sqrt(static_cast<double>(values.size()));
}

/// Means of neighbours, two by two; an odd one at the end is left out.
std::vector<double> halved(std::span<const double> values) {
  std::vector<double> means(values.size() / 2);
  for (std::size_t k = 0; k < means.size(); ++k) means[k] = 0.5 * (values[2 * k] + values[2 * k + 1]);
  return means;
}

bool is_long_enough(std::size_t block_length, double samples_that_count_as_one, std::size_t samples) {
  const auto length = static_cast<double>(block_length);
  return length * length * length >
         2.0 * samples_that_count_as_one * samples_that_count_as_one * static_cast<double>(samples);
}

}  // namespace

BlockAverage block_average(std::span<const double> samples) {
  if (samples.size() < 2) throw FitError("block average: at least two samples are needed");
  if (!std::ranges::all_of(samples, [](double value) { return std::isfinite(value); })) {
    throw FitError("block average: a sample is not finite");
  }
  const auto count = static_cast<double>(samples.size());
  const double first_error = independent_error(samples);
  BlockAverage result{.mean = ensemble_statistics(samples).mean,
                      .standard_error = first_error,
                      .block_length = 1,
                      .effective_number = count,
                      .flat = first_error == 0.0};
  std::vector<double> means(samples.begin(), samples.end());
  for (std::size_t length = 1; !result.flat && means.size() >= least_blocks;
       length *= 2, means = halved(means)) {
    const double error = independent_error(means);
    const double ratio = std::pow(error / first_error, 2);
    result.flat = is_long_enough(length, ratio, samples.size());
    // While no length is enough, the largest error is nearest to the truth.
    if (!result.flat && error < result.standard_error) continue;
    result.standard_error = error;
    result.block_length = length;
    result.effective_number = count / ratio;
  }
  return result;
}

}  // namespace talus::analysis
