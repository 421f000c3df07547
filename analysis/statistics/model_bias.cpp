#include "analysis/statistics/model_bias.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "analysis/statistics/ensemble.h"

namespace talus::analysis {
namespace {

void check(double reference_deviation, double confidence) {
  if (!(reference_deviation >= 0.0) || !std::isfinite(reference_deviation))
    throw std::invalid_argument(fmt::format("model_bias: a reference deviation of {}", reference_deviation));
  if (!(confidence > 0.0 && confidence < 1.0))
    throw std::invalid_argument(fmt::format("model_bias: a confidence of {}", confidence));
}

std::string why_not(std::span<const ModelPair> pairs) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (const double value : {pairs[i].model, pairs[i].reference}) {
      if (!std::isfinite(value) || value <= 0.0)
        return fmt::format("point {} of {} has a value of {}, which has no logarithm", i + 1, pairs.size(),
                           value);
    }
  }
  if (pairs.size() < fewest_bias_points)
    return fmt::format("{} points; a spread needs at least {}", pairs.size(), fewest_bias_points);
  return {};
}

EnsembleStatistics log_ratios(std::span<const ModelPair> pairs) {
  std::vector<double> ratios;
  for (const ModelPair& pair : pairs) ratios.push_back(std::log(pair.model / pair.reference));
  return ensemble_statistics(ratios);
}

}  // namespace

ModelBiasResult model_bias(std::span<const ModelPair> pairs, double reference_deviation, double confidence) {
  check(reference_deviation, confidence);
  if (std::string why = why_not(pairs); !why.empty()) return {std::nullopt, std::move(why)};
  const EnsembleStatistics y = log_ratios(pairs);
  const double n = static_cast<double>(y.count), freedom = n - 1.0, tail = 0.5 * (1.0 - confidence);
  const double variance = std::pow(y.standard_deviation, 2);
  const bool capped = std::pow(reference_deviation, 2) > 0.5 * variance;
  const double of_reference = capped ? 0.5 * variance : std::pow(reference_deviation, 2);
  const double of_model = variance - of_reference;

  const double log_bias = y.mean + 0.5 * (of_model - of_reference);
  const double spread_term = capped ? 0.0 : std::pow(variance, 2) / (2.0 * freedom);
  const double half_width = gsl_cdf_tdist_Qinv(tail, freedom) * std::sqrt(variance / n + spread_term);
  const auto model_deviation = [&](double chi_squared) {
    return std::sqrt(std::max(0.0, freedom * variance / chi_squared - of_reference));
  };
  return {ModelBias{.bias_factor = std::exp(log_bias),
                    .bias_interval = {std::exp(log_bias - half_width), std::exp(log_bias + half_width)},
                    .model_deviation = std::sqrt(of_model),
                    .model_deviation_interval = {model_deviation(gsl_cdf_chisq_Qinv(tail, freedom)),
                                                 model_deviation(gsl_cdf_chisq_Pinv(tail, freedom))},
                    .reference_deviation = std::sqrt(of_reference),
                    .reference_capped = capped},
          {}};
}

}  // namespace talus::analysis
