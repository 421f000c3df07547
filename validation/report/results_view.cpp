#include "validation/report/results_view.h"

#include <fmt/format.h>

#include <cmath>

namespace talus::report {
namespace {

using nlohmann::json;

const json* find(const json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() || found->is_null() ? nullptr : &*found;
}

/// NaN where there is no finite number.
double finite(const json& object, const char* key) {
  const json* value = find(object, key);
  const double number = value && value->is_number() ? value->get<double>() : std::nan("");
  return std::isfinite(number) ? number : std::nan("");
}

}  // namespace

std::string text_of(const json& object, const char* key, const std::string& otherwise) {
  const json* value = find(object, key);
  if (!value) return otherwise;
  return value->is_string() ? value->get<std::string>()
                            : value->dump(-1, ' ', false, json::error_handler_t::replace);
}

const json& list_of(const json& object, const char* key) {
  static const json empty = json::array();
  const json* value = find(object, key);
  return value && value->is_array() ? *value : empty;
}

std::string verdict_of(const json& object, const char* key) {
  const std::string verdict = text_of(object, key);
  return verdict == "PASS" || verdict == "FAIL" ? verdict : "INCONCLUSIVE";
}

std::string percent_of(const json& object, const char* key, bool signed_value) {
  const double share = finite(object, key);
  if (std::isnan(share)) return "-";
  const int decimals = share != 0.0 && std::abs(share) < 1e-3 ? 3 : 1;
  return signed_value ? fmt::format("{:+.{}f} %", 100.0 * share, decimals)
                      : fmt::format("{:.{}f} %", 100.0 * share, decimals);
}

std::string number_of(const json& object, const char* key) {
  const double number = finite(object, key);
  return std::isnan(number) ? "-" : fmt::format("{:.4g}", number);
}

std::vector<Gate> gates_of(const json& results) {
  std::vector<Gate> gates{truth_gate};
  if (find(results, "drift")) gates.push_back(drift_gate);
  return gates;
}

std::string name_of(const json& point) {
  return text_of(point, "name", text_of(point, "case", "?") + "/" + text_of(point, "point", "?"));
}

}  // namespace talus::report
