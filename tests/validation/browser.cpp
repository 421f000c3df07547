#include "tests/validation/browser.h"

#include <stdexcept>

#include "tests/program.h"

namespace talus::testing {

std::string drawn_page(const std::filesystem::path& page) {
  const TestFolder folder;
  const auto log = folder.path() / "log.txt";
  // The document comes on stdout; what Chromium has to say of itself goes to the log.
  const auto result = run_program(
      {"/bin/sh", "-c", "exec \"$@\" 2>\"$0\"", log.string(), "chromium", "--headless", "--no-sandbox",
       "--disable-gpu", "--disable-background-networking", "--disable-component-update", "--disable-sync",
       "--no-first-run", "--window-size=1200,900", "--user-data-dir=" + (folder.path() / "profile").string(),
       "--virtual-time-budget=5000", "--dump-dom", "file://" + std::filesystem::absolute(page).string()},
      120.0);
  if (result.exit_code != 0) throw std::runtime_error("chromium failed: " + read_file(log));
  return result.output;
}

}  // namespace talus::testing
