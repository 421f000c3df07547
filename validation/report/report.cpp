#include "validation/report/report.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "continuum/files/atomic_file.h"
#include "page_parts.h"

namespace talus {
namespace {

/// JSON that can stand inside a <script> element: without '<' nothing in the data can close it. In JSON '<'
/// occurs only within strings, where \u003c means the same.
std::string embeddable(const nlohmann::json& data) {
  const auto text = data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}

/// Replaces each {{name}} of the template. What is put in is not searched again, so data may hold anything.
std::string filled(std::string_view page,
                   std::span<const std::pair<std::string_view, std::string_view>> parts) {
  std::string out;
  while (true) {
    const auto open = page.find("{{");
    out += page.substr(0, open);
    if (open == std::string_view::npos) return out;
    const auto close = page.find("}}", open);
    const auto name = page.substr(open + 2, close - open - 2);
    const auto part =
        std::find_if(parts.begin(), parts.end(), [&](const auto& p) { return p.first == name; });
    if (part == parts.end()) throw std::logic_error("report_template.html asks for an unknown part");
    out += part->second;
    page.remove_prefix(close + 2);
  }
}

}  // namespace

void write_report(const nlohmann::json& results, const nlohmann::json& pictures,
                  const std::filesystem::path& file) {
  const std::string results_text = embeddable(results);
  const std::string pictures_text = embeddable(pictures);
  const std::array<std::pair<std::string_view, std::string_view>, 5> parts{{
      {"style", page_parts::style},
      {"chart.js", page_parts::chart_js},
      {"script", page_parts::script},
      {"results", results_text},
      {"pictures", pictures_text},
  }};
  write_file_atomically(file, filled(page_parts::page, parts));
}

}  // namespace talus
