// draft, replaced by the helper's
#pragma once
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>
#include "analysis/statistics/ensemble.h"
namespace talus::analysis {
struct NumericalRuns { std::vector<double> standard; std::optional<double> coarse, short_steps; };
struct NumericalUncertainty { std::optional<double> seeds, grid, time_step, combined; };
inline NumericalUncertainty numerical_uncertainty(const NumericalRuns& r) {
  NumericalUncertainty u;
  const auto s = ensemble_statistics(r.standard);
  if (s.count > 1) u.seeds = s.standard_deviation / std::sqrt(s.count);
  if (r.coarse) u.grid = std::abs(*r.coarse - r.standard.front()) / std::numbers::sqrt3;
  if (r.short_steps) u.time_step = std::abs(*r.short_steps - r.standard.front()) / std::numbers::sqrt3 * 2.0;
  if (u.seeds && u.grid && u.time_step) u.combined = std::hypot(*u.seeds, *u.grid, *u.time_step);
  return u;
}
}
