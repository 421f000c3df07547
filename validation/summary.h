// Results as text for the terminal.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace talus::validation {

/// Observables by code, deviation, band, uncertainty and verdict of every point; then what drifted; then both gates' verdicts.
std::string summary_text(const nlohmann::json& results);

/// Two results of the same suite, or of two, observable by observable: {"a", "b", "rows": [{name, observable, a, b, change, verdict_a,
/// verdict_b}]}; what only one of them holds has null on the other side.
nlohmann::json comparison_of(const nlohmann::json& a, const nlohmann::json& b);
std::string comparison_text(const nlohmann::json& comparison);

}  // namespace talus::validation
