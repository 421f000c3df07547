// Values of an observable over the runs of a point in results.json.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analysis/statistics/ensemble.h"

namespace talus::validation {

/// The runs of one code.
inline std::vector<const nlohmann::json*> runs_of(const nlohmann::json& runs, const std::string& code) {
  std::vector<const nlohmann::json*> found;
  for (const auto& run : runs) {
    if (run.at("code") == code) found.push_back(&run);
  }
  return found;
}

/// NaN where a run has no such number.
inline std::vector<double> values_of(const nlohmann::json& runs, const std::string& code,
                                     const std::string& observable) {
  std::vector<double> values;
  for (const auto* run : runs_of(runs, code)) {
    const auto& observables = run->at("observables");
    const auto found = observables.find(observable);
    values.push_back(found != observables.end() && found->is_number() ? found->get<double>() : std::nan(""));
  }
  return values;
}

inline nlohmann::json finite_or_null(double x) {
  return std::isfinite(x) ? nlohmann::json(x) : nlohmann::json();
}

/// {"mean", "sd", "n"}, or null for no values.
inline nlohmann::json statistics_json(const std::vector<double>& values) {
  if (values.empty()) return nullptr;
  const auto s = analysis::ensemble_statistics(values);
  return {{"mean", finite_or_null(s.mean)}, {"sd", finite_or_null(s.standard_deviation)}, {"n", s.count}};
}

}  // namespace talus::validation
