// A real browser for tests: headless Chromium.
#pragma once

#include <filesystem>
#include <string>

namespace talus::testing {

/// Opens `page` in headless Chromium, lets its scripts run, and returns the document as it then stands, as
/// HTML. Throws std::runtime_error when Chromium is missing, fails, or takes longer than two minutes.
std::string drawn_page(const std::filesystem::path& page);

struct BrowserView {
  std::string document;  // as drawn_page() gives it
  std::string console;   // what the page and the browser said of it, a line each; empty when all is well
};

/// The same, and what was said meanwhile. `address`: a path, which may end in a #fragment.
BrowserView view_page(const std::string& address);

}  // namespace talus::testing
