// The page on paper, by the browser's own printing.
#include <fmt/format.h>
#include <unistd.h>

#include <cctype>
#include <chrono>
#include <cstdlib>

#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"
#include "continuum/files/process.h"
#include "validation/report/other_formats.h"

namespace talus {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::minutes time_limit{3};

fs::path chromium() {
  if (const char* named = std::getenv("TALUS_CHROMIUM"); named && *named) {
    if (::access(named, X_OK) != 0 || !fs::is_regular_file(named)) {
      throw InputError(fmt::format("TALUS_CHROMIUM names '{}', which is not a program", named));
    }
    return named;
  }
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
    try {
      return find_program(name, "chromium");
    } catch (const InputError&) {
      continue;
    }
  }
  throw InputError(
      "a PDF needs Chromium, and none of chromium, chromium-browser, google-chrome is on PATH; install it "
      "with: "
      "apt-get install chromium, or name it in TALUS_CHROMIUM");
}

/// A file's address, whatever its name holds.
std::string address_of(const fs::path& file) {
  std::string out = "file://";
  for (const char c : fs::absolute(file).string()) {
    const bool safe =
        std::isalnum(static_cast<unsigned char>(c)) || c == '/' || c == '-' || c == '_' || c == '.';
    out += safe ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

}  // namespace

void write_pdf(const fs::path& report_html, const fs::path& pdf_file) {
  if (!fs::is_regular_file(report_html))
    throw InputError(fmt::format("there is no report {}", report_html.string()));
  const ScratchFolder scratch;
  const fs::path printed = scratch.path() / "report.pdf";
  ProcessRequest request{
      .command = {chromium().string(), "--headless", "--disable-gpu", "--disable-background-networking",
                  "--disable-component-update", "--disable-sync", "--no-first-run", "--window-size=1200,900",
                  "--virtual-time-budget=10000", "--no-pdf-header-footer",
                  "--user-data-dir=" + (scratch.path() / "profile").string(),
                  "--print-to-pdf=" + printed.string()},
      .folder = scratch.path(),
      .log = "chromium.log",
      .environment = {},
      .time_limit = time_limit,
      .stop = {}};
  // Root has no sandbox of its own to put Chromium in; the page forbids itself the network and runs no text as code.
  if (::geteuid() == 0) request.command.push_back("--no-sandbox");
  request.command.push_back(address_of(report_html) + "#all");
  const auto result = run_process(request);
  if (result.timed_out || result.exit_code != 0 || !fs::exists(printed)) {
    const std::string log = read_file(scratch.path() / "chromium.log");
    throw InputError(fmt::format(
        "Chromium made no PDF of {} ({}): {}", report_html.string(),
        result.timed_out ? "it took over three minutes" : fmt::format("exit code {}", result.exit_code),
        log.substr(0, 2000)));
  }
  write_file_atomically(pdf_file, read_file(printed));
}

}  // namespace talus
