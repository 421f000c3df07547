// What the other formats ask of results.json, with nothing assumed to be there.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace talus::report {

/// The text under `key`, or `otherwise` when there is none; numbers and the like as JSON writes them.
std::string text_of(const nlohmann::json& object, const char* key, const std::string& otherwise = "");

/// The list under `key`; empty when there is none.
const nlohmann::json& list_of(const nlohmann::json& object, const char* key);

/// "PASS" or "FAIL"; everything else, the absent included, is "INCONCLUSIVE".
std::string verdict_of(const nlohmann::json& object, const char* key = "verdict");

/// "+2.7 %", or "-" when there is no number. `signed_value`: with its sign.
std::string percent_of(const nlohmann::json& object, const char* key, bool signed_value);

/// A number to four digits, or "-".
std::string number_of(const nlohmann::json& object, const char* key);

struct Gate {
  const char* key;          // of a point: its rows
  const char* verdict_key;  // of a point
  const char* change_key;   // of a row
};
inline constexpr Gate truth_gate{"truth", "verdict", "deviation"};
inline constexpr Gate drift_gate{"drift", "drift_verdict", "change"};

/// The gates that these results were put to: truth always, drift when they know of it.
std::vector<Gate> gates_of(const nlohmann::json& results);

std::string name_of(const nlohmann::json& point);

}  // namespace talus::report
