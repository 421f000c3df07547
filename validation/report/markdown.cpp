// The summary for a pull request, and the annotations of a workflow.
#include <fmt/format.h>

#include "validation/report/other_formats.h"
#include "validation/report/results_view.h"

namespace talus {
namespace {

using namespace report;
using nlohmann::json;

/// Plain text inside a markdown table: nothing of it is markup, a mention or the end of the cell.
std::string plain(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '\n':
      case '\r':
      case '\t':
        out += ' ';
        break;
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '@':
        out += "&#64;";
        break;
      case '#':
        out += "&#35;";
        break;
      case '|':
      case '\\':
      case '`':
      case '*':
      case '_':
      case '~':
      case '[':
      case ']':
      case '!':
        out += '\\';
        out += c;
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string sign_of(const std::string& verdict) {
  if (verdict == "PASS") return "✅";
  return verdict == "FAIL" ? "❌" : "❔";
}

std::string marked(const std::string& verdict) { return sign_of(verdict) + " " + verdict; }

const json& drift_of(const json& results) {
  static const json none;
  return results.contains("drift") ? results["drift"] : none;
}

/// "3 of 5" rows that passed; "none" when there are no rows.
std::string passed_of(const json& point, const Gate& gate) {
  const json& rows = list_of(point, gate.key);
  int passed = 0;
  for (const json& row : rows) passed += verdict_of(row) == "PASS" ? 1 : 0;
  return rows.empty() ? "none compared" : fmt::format("{} of {}", passed, rows.size());
}

std::string points_table(const json& results) {
  std::string out = "| point | truth | observables passed | drift |\n|---|---|---|---|\n";
  for (const json& point : list_of(results, "points")) {
    const bool drift = gates_of(results).size() > 1;
    out +=
        fmt::format("| {} | {} | {} | {} |\n", plain(name_of(point)), marked(verdict_of(point)),
                    passed_of(point, truth_gate), drift ? marked(verdict_of(point, "drift_verdict")) : "-");
  }
  return out;
}

/// The rows of the truth gate that did not pass; empty when all did.
std::string not_passed(const json& results) {
  std::string rows;
  for (const json& point : list_of(results, "points")) {
    for (const json& row : list_of(point, "truth")) {
      if (verdict_of(row) == "PASS") continue;
      rows += fmt::format("| {} | {} | {} | {} | ±{} | ±{} | {} |\n", plain(name_of(point)),
                          plain(text_of(row, "observable", "?")), marked(verdict_of(row)),
                          percent_of(row, "deviation", true), percent_of(row, "band", false),
                          percent_of(row, "uncertainty", false), plain(text_of(row, "why")));
    }
  }
  if (rows.empty()) return "";
  return "### Truth: what did not pass\n\n| point | observable | verdict | deviation | band | k·u | why "
         "|\n|---|---|---|---|---|---|---|\n" +
         rows + "\n";
}

std::string changes(const json& results) {
  std::string rows;
  for (const json& point : list_of(results, "points")) {
    for (const json& row : list_of(point, "drift")) {
      if (verdict_of(row) == "PASS") continue;
      rows += fmt::format("| {} | {} | {} | {} → {} | {} | ±{} |\n", plain(name_of(point)),
                          plain(text_of(row, "observable", "?")), marked(verdict_of(row)),
                          number_of(row, "baseline"), number_of(row, "now"), percent_of(row, "change", true),
                          percent_of(row, "tolerance", false));
    }
  }
  const std::string title = "### What changed since the baseline\n\n";
  if (gates_of(results).size() < 2) return title + "There is no drift gate in these results.\n";
  if (rows.empty()) {
    const std::string why = plain(text_of(drift_of(results), "why"));
    return title + (why.empty() ? "Nothing moved beyond its tolerance." : why) + "\n";
  }
  return title +
         "| point | observable | verdict | baseline → now | change | tolerance "
         "|\n|---|---|---|---|---|---|\n" +
         rows;
}

/// Data of a workflow command; `property`: within its head, where more characters have a meaning.
std::string command_text(const std::string& text, bool property) {
  std::string out;
  for (const char c : text) {
    if (c == '%') {
      out += "%25";
    } else if (c == '\r') {
      out += "%0D";
    } else if (c == '\n') {
      out += "%0A";
    } else if (property && c == ':') {
      out += "%3A";
    } else if (property && c == ',') {
      out += "%2C";
    } else {
      out += c;
    }
  }
  return out;
}

}  // namespace

std::string markdown_summary(const json& results) {
  std::string out =
      fmt::format("## Talus validation: {}\n\n", plain(text_of(results, "suite", "unnamed suite")));
  out += fmt::format("**Truth** (continuum against DEM): {}\n\n", marked(verdict_of(results)));
  const std::string why = plain(text_of(drift_of(results), "why"));
  out += fmt::format("**Drift** (since the baseline): {}{}\n\n",
                     gates_of(results).size() > 1 ? marked(verdict_of(drift_of(results))) : "no drift gate",
                     why.empty() ? "" : " · " + why);
  if (!results.is_object() || results.value("complete", json(false)) != true)
    out += "These results are **not complete**.\n\n";
  out += points_table(results) + "\n" + not_passed(results) + changes(results);
  const json none;
  const json& made = results.contains("provenance") ? results["provenance"] : none;
  const std::string hash = text_of(made, "git_hash");
  if (!hash.empty())
    out += fmt::format("\n<sub>{}, git {}</sub>\n", plain(text_of(made, "time_utc", "no time")),
                       plain(hash.substr(0, 12)));
  return out;
}

std::string annotations(const json& results) {
  std::string out;
  for (const json& point : list_of(results, "points")) {
    for (const Gate& gate : gates_of(results)) {
      for (const json& row : list_of(point, gate.key)) {
        const std::string verdict = verdict_of(row);
        if (verdict == "PASS") continue;
        const std::string title =
            fmt::format("{} {}: {}", name_of(point), gate.key, text_of(row, "observable", "?"));
        const std::string message =
            fmt::format("{}, {}: {}", verdict, percent_of(row, gate.change_key, true), text_of(row, "why"));
        out += fmt::format("::{} title={}::{}\n", verdict == "FAIL" ? "error" : "warning",
                           command_text(title, true), command_text(message, false));
      }
    }
  }
  return out;
}

}  // namespace talus
