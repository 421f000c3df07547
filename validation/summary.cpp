#include "validation/summary.h"

#include <fmt/format.h>

#include <map>

#include "validation/backends/continuum.h"

namespace talus::validation {
namespace {

using nlohmann::json;

std::string number(const json& value, const char* format) {
  return value.is_number() ? fmt::format(fmt::runtime(format), value.get<double>()) : std::string("-");
}

std::string percent(const json& value, const char* format = "{:+.1f} %") {
  return value.is_number() ? fmt::format(fmt::runtime(format), 100.0 * value.get<double>())
                           : std::string("-");
}

std::string mean_and_spread(const json& statistics) {
  if (!statistics.is_object()) return "-";
  return fmt::format("{} +- {}", number(statistics.at("mean"), "{:.4g}"),
                     number(statistics.at("sd"), "{:.2g}"));
}

std::string text(const json& row, const char* key) { return row.at(key).get<std::string>(); }

std::string truth_table(const json& point) {
  std::string table = fmt::format("{} ({})\n{:<22}{:>19}{:>19}{:>19}{:>11}{:>7}{:>8}  {}\n",
                                  text(point, "title"), text(point, "name"), "", "continuum", "liggghts",
                                  "yade", "deviation", "band", "U", "verdict");
  for (const auto& row : point.at("truth")) {
    const std::string unit = text(row, "unit");
    table += fmt::format("{:<22}{:>19}{:>19}{:>19}{:>11}{:>7}{:>8}  {}: {}\n",
                         text(row, "observable") + (unit == "1" ? "" : ", " + unit),
                         mean_and_spread(row.at(continuum_code)), mean_and_spread(row.at("liggghts")),
                         mean_and_spread(row.at("yade")), percent(row.at("deviation")),
                         percent(row.at("band"), "{:.0f} %"), percent(row.at("uncertainty"), "{:.1f} %"),
                         text(row, "verdict"), text(row, "why"));
  }
  return table;
}

std::string drift_lines(const json& results) {
  std::string lines;
  for (const auto& point : results.at("points")) {
    for (const auto& row : point.at("drift")) {
      if (row.at("verdict") == "PASS" || row.at("baseline").is_null()) continue;
      lines += fmt::format("drift: {} {}: {} -> {} ({}, tolerance {}): {}\n", text(point, "name"),
                           text(row, "observable"), number(row.at("baseline"), "{:.6g}"),
                           number(row.at("now"), "{:.6g}"), percent(row.at("change"), "{:+.2f} %"),
                           percent(row.at("tolerance"), "{:.2f} %"), text(row, "why"));
    }
  }
  return lines;
}

/// Continuum means and verdicts by point and observable.
std::map<std::pair<std::string, std::string>, json> rows_of(const json& results) {
  std::map<std::pair<std::string, std::string>, json> rows;
  for (const auto& point : results.at("points")) {
    for (const auto& row : point.at("truth")) {
      const auto& statistics = row.at(continuum_code);
      rows[{text(point, "name"), text(row, "observable")}] = {
          {"value", statistics.is_object() ? statistics.at("mean") : row.at("deviation")},
          {"verdict", row.at("verdict")}};
    }
  }
  return rows;
}

json label_of(const json& results) {
  const auto& made = results.at("provenance");
  return {{"suite", results.at("suite")},
          {"git_hash", made.value("git_hash", "")},
          {"time_utc", made.value("time_utc", "")}};
}

}  // namespace

std::string summary_text(const json& results) {
  std::string all;
  for (const auto& point : results.at("points")) {
    if (!point.at("truth").empty()) all += truth_table(point) + "\n";
  }
  all += drift_lines(results);
  return all + fmt::format("drift verdict: {} ({})\ntruth verdict: {}\n",
                           text(results.at("drift"), "verdict"), text(results.at("drift"), "why"),
                           text(results, "verdict"));
}

json comparison_of(const json& a, const json& b) {
  const auto rows_a = rows_of(a);
  auto rows_b = rows_of(b);
  json rows = json::array();
  const auto add = [&](const auto& name, const json& of_a, const json& of_b) {
    const json value_a = of_a.value("value", json()), value_b = of_b.value("value", json());
    const bool both = value_a.is_number() && value_b.is_number() && value_a.get<double>() != 0.0;
    rows.push_back({{"name", name.first},
                    {"observable", name.second},
                    {"a", value_a},
                    {"b", value_b},
                    {"change", both ? json(value_b.get<double>() / value_a.get<double>() - 1.0) : json()},
                    {"verdict_a", of_a.value("verdict", json())},
                    {"verdict_b", of_b.value("verdict", json())}});
  };
  for (const auto& [name, row] : rows_a) {
    const auto other = rows_b.find(name);
    add(name, row, other == rows_b.end() ? json::object() : other->second);
    if (other != rows_b.end()) rows_b.erase(other);
  }
  for (const auto& [name, row] : rows_b) add(name, json::object(), row);
  return {{"a", label_of(a)}, {"b", label_of(b)}, {"rows", rows}};
}

std::string comparison_text(const json& comparison) {
  std::string all =
      fmt::format("{:<36}{:<18}{:>12}{:>12}{:>10}  verdict\n", "", "observable", "A", "B", "change");
  const auto verdict = [](const json& value) {
    return value.is_string() ? value.get<std::string>() : std::string("-");
  };
  for (const auto& row : comparison.at("rows")) {
    all +=
        fmt::format("{:<36}{:<18}{:>12}{:>12}{:>10}  {}{}\n", text(row, "name"), text(row, "observable"),
                    number(row.at("a"), "{:.5g}"), number(row.at("b"), "{:.5g}"),
                    percent(row.at("change"), "{:+.2f} %"), verdict(row.at("verdict_a")),
                    row.at("verdict_a") == row.at("verdict_b") ? "" : " -> " + verdict(row.at("verdict_b")));
  }
  return all;
}

}  // namespace talus::validation
