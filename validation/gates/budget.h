// Uncertainties of one comparison, relative to the reference: what the discrete codes leave open, and the continuum's own numbers.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace talus::validation {

/// Standard uncertainties; what is not known is absent, not zero.
struct Budget {
  std::optional<double> seeds, codes, measuring, reference;         // reference: combined
  std::optional<double> lattice_seeds, grid, time_step, numerical;  // numerical: combined

  /// k sqrt(u_ref^2 + u_num^2); absent when either is.
  std::optional<double> expanded(double k) const {
    if (!reference || !numerical) return std::nullopt;
    return k * std::hypot(*reference, *numerical);
  }
};

inline nlohmann::json or_null(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? nlohmann::json(*value) : nlohmann::json();
}

/// {"u_reference": {...}, "u_numerical": {...}} as results.json has them.
inline nlohmann::json budget_json(const Budget& b) {
  return {{"u_reference",
           {{"seeds", or_null(b.seeds)},
            {"codes", or_null(b.codes)},
            {"measuring", or_null(b.measuring)},
            {"combined", or_null(b.reference)}}},
          {"u_numerical",
           {{"seeds", or_null(b.lattice_seeds)},
            {"grid", or_null(b.grid)},
            {"time_step", or_null(b.time_step)},
            {"combined", or_null(b.numerical)}}}};
}

}  // namespace talus::validation
