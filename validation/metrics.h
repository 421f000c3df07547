// Figures of a whole suite: how far the model is off on the whole, beside the verdicts on single comparisons.
#pragma once

#include <nlohmann/json.hpp>

namespace talus::validation {

/// "metrics" of results.json: for each observable that could be judged at three points at least, the bias factor and the relative standard deviation of
/// the continuum over the reference (analysis/statistics/model_bias.h), and whether the bias lies within the band (equivalence.h).
nlohmann::json suite_metrics(const nlohmann::json& results);

/// "beverloo" of results.json: the law of Beverloo fitted to each code's slots, for each material with at least three openings
/// (analysis/statistics/beverloo.h): C and k by the law as it is; and the exponent for a k that is given, 0 for the continuum and 1.4 for
/// grains (corrected.h), since three openings cannot tell k from the exponent.
nlohmann::json beverloo_fits(const nlohmann::json& results);

}  // namespace talus::validation
