#include "analysis/statistics/uncertainty.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace talus::analysis {
namespace {

void check(std::span<const CodeValues> codes, double measurement_standard) {
  if (codes.empty()) throw std::invalid_argument("combine_uncertainty: no codes");
  if (!(measurement_standard >= 0.0) || !std::isfinite(measurement_standard)) {
    throw std::invalid_argument(
        fmt::format("combine_uncertainty: a measurement uncertainty of {}", measurement_standard));
  }
  std::set<std::string> names;
  for (const CodeValues& code : codes) {
    if (!names.insert(code.code).second) {
      throw std::invalid_argument(fmt::format("combine_uncertainty: {} stands there twice", code.code));
    }
    if (code.values.empty()) {
      throw std::invalid_argument(fmt::format("combine_uncertainty: {} has no values", code.code));
    }
    if (!std::ranges::all_of(code.values, [](double value) { return std::isfinite(value); })) {
      throw std::invalid_argument(fmt::format("combine_uncertainty: a value of {} is not finite", code.code));
    }
  }
}

CodeSummary summary_of(const CodeValues& code) {
  const EnsembleStatistics statistics = ensemble_statistics(code.values);
  CodeSummary summary{code.code, statistics, std::nullopt};
  if (statistics.count > 1) {
    summary.standard_error = statistics.standard_deviation / std::sqrt(static_cast<double>(statistics.count));
  }
  return summary;
}

void add_seeds(Uncertainty& result) {
  double squares = 0.0, inverse_counts = 0.0;
  for (const CodeSummary& code : result.codes) {
    const auto count = static_cast<double>(code.statistics.count);
    inverse_counts += 1.0 / count;
    if (code.statistics.count < 2) continue;
    squares += (count - 1.0) * std::pow(code.statistics.standard_deviation, 2);
    result.seed_degrees_of_freedom += static_cast<int>(code.statistics.count) - 1;
  }
  if (result.seed_degrees_of_freedom == 0) return;
  result.seed_deviation = std::sqrt(squares / result.seed_degrees_of_freedom);
  result.seed_standard =
      *result.seed_deviation * std::sqrt(inverse_counts) / static_cast<double>(result.codes.size());
}

void add_codes(Uncertainty& result) {
  if (result.codes.size() < 2) return;
  const auto mean = [](const CodeSummary& code) { return code.statistics.mean; };
  const auto [least, most] = std::ranges::minmax_element(result.codes, {}, mean);
  result.code_difference = mean(*most) - mean(*least);
  result.code_standard = *result.code_difference / 2.0 / std::sqrt(3.0);
}

}  // namespace

Uncertainty combine_uncertainty(std::span<const CodeValues> codes, double measurement_standard) {
  check(codes, measurement_standard);
  Uncertainty result{};
  result.measurement_standard = measurement_standard;
  for (const CodeValues& code : codes) {
    result.codes.push_back(summary_of(code));
    result.value += result.codes.back().statistics.mean / static_cast<double>(codes.size());
  }
  add_seeds(result);
  add_codes(result);
  if (result.seed_standard) {
    result.combined =
        std::hypot(*result.seed_standard, result.code_standard.value_or(0.0), measurement_standard);
  }
  return result;
}

}  // namespace talus::analysis
