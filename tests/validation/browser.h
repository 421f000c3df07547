// A real browser for tests: headless Chromium.
#pragma once

#include <filesystem>
#include <string>

namespace talus::testing {

/// Opens `page` in headless Chromium, lets its scripts run, and returns the document as it then stands, as
/// HTML. Throws std::runtime_error when Chromium is missing, fails, or takes longer than two minutes.
std::string drawn_page(const std::filesystem::path& page);

}  // namespace talus::testing
