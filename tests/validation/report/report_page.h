// What tests of the page share: the report as a browser shows it, and ways to read that.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>

#include "continuum/files/atomic_file.h"
#include "tests/test_folder.h"
#include "tests/validation/browser.h"
#include "validation/report/report.h"

namespace talus::testing {

inline constexpr int summary_charts = 4;  // all observables, one of them, discharge, history
// Four curves, profile, animation, fields of the column; the slot's mass; the heap's profile.
inline constexpr int all_charts = summary_charts + 7 + 1 + 1;
inline constexpr const char* every_point = "#all";

class ReportPage : public ::testing::Test {
 protected:
  /// `script`: run once the page has drawn itself.
  BrowserView viewed(const nlohmann::json& results, const nlohmann::json& pictures,
                     const std::string& fragment = every_point, const std::string& script = "") const {
    const auto file = folder.path() / "report.html";
    write_report(results, pictures, file);
    if (!script.empty()) {
      std::string page = read_file(file);
      page.insert(page.rfind("</body>"), "<script>" + script + "</script>");
      write_file_atomically(file, page);
    }
    return view_page(file.string() + fragment);
  }

  TestFolder folder;
};

/// The page without its scripts: what the reader sees.
inline std::string visible(const std::string& page) {
  std::string out;
  std::size_t place = 0;
  while (true) {
    const auto open = page.find("<script", place);
    out += page.substr(place, open - place);
    if (open == std::string::npos) return out;
    place = page.find("</script>", open) + 9;
  }
}

inline std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++count;
  return count;
}

inline std::multiset<std::string> all_matches(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  std::multiset<std::string> found;
  for (std::sregex_iterator match(text.begin(), text.end(), expression), end; match != end; ++match) {
    found.insert((*match)[1]);
  }
  return found;
}

inline std::string charts(int count) { return fmt::format("data-charts=\"{}\"", count); }
inline constexpr const char* no_errors = "data-errors=\"0\"";

}  // namespace talus::testing
