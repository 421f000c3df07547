// Figures of a whole suite: how far the model is off on the whole, beside the verdicts on single comparisons.
#pragma once

#include <nlohmann/json.hpp>

namespace talus::validation {

/// "metrics" of results.json: for each observable that at least two points compare, the bias factor and the relative standard deviation of
/// the continuum over the reference (analysis/statistics/model_bias.h), and whether the bias lies within the band (equivalence.h).
nlohmann::json suite_metrics(const nlohmann::json& results);

/// "beverloo" of results.json: the law of Beverloo fitted to each code's slots, for each material with at least three openings
/// (analysis/statistics/beverloo.h). A continuum has no grain size: its raw rate is that of k = 0, so C and the exponent are compared apart.
nlohmann::json beverloo_fits(const nlohmann::json& results);

}  // namespace talus::validation
