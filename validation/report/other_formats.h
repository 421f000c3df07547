// The results for machines and for those who do not open the page: JUnit XML, a markdown summary, workflow annotations, PDF.
//
// All read results.json, schema version 2, and take what is absent or null as absent. A verdict that is neither PASS nor FAIL,
// a point without comparisons, and a gate without rows count as inconclusive: nothing missing ever reads as a pass.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace talus {

/// JUnit XML: one <testsuite> for each point and gate ("column_collapse/a_1 truth"), one <testcase> for each observable. FAIL is a
/// <failure>, INCONCLUSIVE an <error>: readers of JUnit count a <skipped> test as harmless, which a comparison that could not
/// be made is not. Drift suites are left out when the results know of no drift gate. Throws InputError when the
/// file cannot be written.
void write_junit(const nlohmann::json& results, const std::filesystem::path& file);

/// For a pull request: the two verdicts, a table of the points, what did not pass, then what changed since the baseline.
std::string markdown_summary(const nlohmann::json& results);

/// GitHub workflow commands, one a line: an error for each FAIL, a warning for each INCONCLUSIVE; empty when all passed.
std::string annotations(const nlohmann::json& results);

/// Prints the page through headless Chromium, every point opened. Chromium is what the environment variable TALUS_CHROMIUM
/// names, otherwise the first of chromium, chromium-browser, google-chrome on PATH. Throws InputError when there is none, or
/// it fails or takes over three minutes, or a file cannot be read or written; the old PDF, if any, is then untouched.
void write_pdf(const std::filesystem::path& report_html, const std::filesystem::path& pdf_file);

}  // namespace talus
