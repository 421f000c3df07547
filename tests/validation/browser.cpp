#include "tests/validation/browser.h"

#include <sstream>
#include <stdexcept>

#include "tests/program.h"

namespace talus::testing {

BrowserView view_page(const std::string& address) {
  const TestFolder folder;
  const auto log = folder.path() / "log.txt";
  // The document comes on stdout; what Chromium has to say of itself goes to the log.
  const auto result = run_program(
      {"/bin/sh", "-c", "exec \"$@\" 2>\"$0\"", log.string(), "chromium", "--headless", "--no-sandbox",
       "--disable-gpu", "--disable-background-networking", "--disable-component-update", "--disable-sync",
       "--no-first-run", "--enable-logging=stderr", "--window-size=1200,900",
       "--user-data-dir=" + (folder.path() / "profile").string(), "--virtual-time-budget=5000", "--dump-dom",
       "file://" + std::filesystem::absolute(address).string()},
      120.0);
  const std::string said = read_file(log);
  if (result.exit_code != 0) throw std::runtime_error("chromium failed: " + said);
  BrowserView view{result.output, ""};
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("CONSOLE") != std::string::npos) view.console += line + "\n";
  }
  return view;
}

std::string drawn_page(const std::filesystem::path& page) { return view_page(page.string()).document; }

}  // namespace talus::testing
