// JUnit XML of the two gates.
#include <fmt/format.h>

#include <pugixml.hpp>
#include <sstream>

#include "continuum/files/atomic_file.h"
#include "validation/report/other_formats.h"
#include "validation/report/results_view.h"

namespace talus {
namespace {

using namespace report;
using nlohmann::json;

struct Counts {
  int tests = 0, failures = 0, errors = 0;
  Counts& operator+=(const Counts& other) {
    tests += other.tests;
    failures += other.failures;
    errors += other.errors;
    return *this;
  }
};

/// XML 1.0 has no control characters but tab and line ends, escaped or not. A byte that is no UTF-8 goes as well.
std::string xml_text(const std::string& text) {
  const std::string valid =
      json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
  std::string out;
  for (const char c : valid) {
    const auto code = static_cast<unsigned char>(c);
    if (code >= 0x20 || c == '\t' || c == '\n' || c == '\r') out += c;
  }
  return out;
}

void set(pugi::xml_node node, const char* attribute, const std::string& value) {
  node.append_attribute(attribute) = xml_text(value).c_str();
}

void set_counts(pugi::xml_node node, const Counts& counts) {
  node.append_attribute("tests") = counts.tests;
  node.append_attribute("failures") = counts.failures;
  node.append_attribute("errors") = counts.errors;
  node.append_attribute("skipped") = 0;
}

Counts add_case(pugi::xml_node suite, const std::string& class_name, const std::string& name,
                const std::string& verdict, const std::string& message, const std::string& detail) {
  auto test = suite.append_child("testcase");
  set(test, "classname", class_name);
  set(test, "name", name);
  if (verdict == "PASS") return {1, 0, 0};
  const bool failed = verdict == "FAIL";
  auto outcome = test.append_child(failed ? "failure" : "error");
  set(outcome, "type", verdict);
  set(outcome, "message", message);
  outcome.append_child(pugi::node_pcdata).set_value(xml_text(detail).c_str());
  return {1, failed ? 1 : 0, failed ? 0 : 1};
}

std::string detail_of(const json& row, const Gate& gate) {
  if (std::string(gate.key) == "truth") {
    return fmt::format("deviation {}, band {}, expanded uncertainty {}", percent_of(row, "deviation", true),
                       percent_of(row, "band", false), percent_of(row, "uncertainty", false));
  }
  return fmt::format("baseline {}, now {}, change {}, tolerance {}", number_of(row, "baseline"),
                     number_of(row, "now"), percent_of(row, "change", true),
                     percent_of(row, "tolerance", false));
}

Counts add_suite(pugi::xml_node root, const json& results, const json& point, const Gate& gate) {
  auto suite = root.append_child("testsuite");
  const std::string name = name_of(point);
  set(suite, "name", name + " " + gate.key);
  Counts counts;
  for (const json& row : list_of(point, gate.key)) {
    counts += add_case(suite, name + "." + gate.key, text_of(row, "observable", "?"), verdict_of(row),
                       text_of(row, "why"), detail_of(row, gate));
  }
  if (counts.tests == 0) {
    counts += add_case(suite, name + "." + gate.key, "anything compared", "INCONCLUSIVE",
                       "nothing was compared", "");
  }
  const json none;
  const json& made = results.contains("provenance") ? results["provenance"] : none;
  if (const std::string when = text_of(made, "time_utc"); !when.empty()) set(suite, "timestamp", when);
  set_counts(suite, counts);
  return counts;
}

}  // namespace

void write_junit(const json& results, const std::filesystem::path& file) {
  pugi::xml_document document;
  auto root = document.append_child("testsuites");
  set(root, "name", "talus " + text_of(results, "suite", "unnamed"));
  Counts counts;
  for (const json& point : list_of(results, "points")) {
    // What the continuum does not run is no comparison that failed to be made.
    const bool compared = std::ranges::any_of(
        list_of(point, "runs"), [](const json& run) { return text_of(run, "code") == "continuum"; });
    if (!compared && !list_of(point, "runs").empty()) continue;
    for (const Gate& gate : gates_of(results)) counts += add_suite(root, results, point, gate);
  }
  if (counts.tests == 0) {
    auto suite = root.append_child("testsuite");
    set(suite, "name", "results");
    const Counts none =
        add_case(suite, "results", "any point", "INCONCLUSIVE", "the results hold no point", "");
    set_counts(suite, none);
    counts += none;
  }
  set_counts(root, counts);
  std::ostringstream text;
  document.save(text, "  ");
  write_file_atomically(file, text.str());
}

}  // namespace talus
