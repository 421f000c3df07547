#include "analysis/statistics/numerical_uncertainty.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/statistics/ensemble.h"

namespace talus::analysis {
namespace {

void check(const NumericalRuns& runs) {
  if (runs.standard.empty()) throw std::invalid_argument("numerical_uncertainty: no standard run");
  std::vector<double> values = runs.standard;
  for (const auto& single : {runs.coarse, runs.short_steps}) values.push_back(single.value_or(0.0));
  for (const double value : values) {
    if (!std::isfinite(value))
      throw std::invalid_argument(fmt::format("numerical_uncertainty: a value of {}", value));
  }
  for (const double ratio : {runs.grid_ratio, runs.step_ratio}) {
    if (!(ratio > 1.0) || !std::isfinite(ratio))
      throw std::invalid_argument(fmt::format("numerical_uncertainty: a ratio of {}", ratio));
  }
}

NumericalPart part_of(double difference, double error_per_difference, std::optional<double> seed_noise) {
  const double half_width = std::abs(difference) * error_per_difference;
  return {difference, half_width, half_width / std::sqrt(3.0), seed_noise};
}

void combine(NumericalUncertainty& result) {
  double squares = 0.0;
  const auto add = [&](const char* name, const std::optional<double>& standard) {
    if (standard)
      squares += *standard * *standard;
    else
      result.missing.emplace_back(name);
  };
  const auto standard_of = [](const std::optional<NumericalPart>& part) {
    return part ? std::optional(part->standard) : std::nullopt;
  };
  add("seeds", result.seed_standard);
  add("grid", standard_of(result.grid));
  add("time_step", standard_of(result.time_step));
  if (result.missing.size() < 3) result.combined = std::sqrt(squares);
}

}  // namespace

NumericalUncertainty numerical_uncertainty(const NumericalRuns& runs) {
  check(runs);
  const EnsembleStatistics seeds = ensemble_statistics(runs.standard);
  const auto n = static_cast<double>(seeds.count);
  NumericalUncertainty result{};
  result.value = seeds.mean;
  if (seeds.count > 1) {
    result.seed_deviation = seeds.standard_deviation;
    result.seed_standard = seeds.standard_deviation / std::sqrt(n);
  }
  const auto noise = [&](double of_one) {
    return result.seed_deviation ? std::optional(*result.seed_deviation * of_one) : std::nullopt;
  };
  if (runs.coarse) {
    result.grid =
        part_of(*runs.coarse - seeds.mean, 1.0 / (runs.grid_ratio - 1.0), noise(std::sqrt(1.0 + 1.0 / n)));
  }
  if (runs.short_steps) {
    result.time_step = part_of(*runs.short_steps - runs.standard.front(),
                               runs.step_ratio / (runs.step_ratio - 1.0), noise(std::sqrt(2.0)));
  }
  combine(result);
  return result;
}

}  // namespace talus::analysis
