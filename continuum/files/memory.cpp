#include "continuum/files/memory.h"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <limits>

namespace talus {

double memory_of_machine() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
  if (pages <= 0 || page <= 0) return std::numeric_limits<double>::infinity();
  return static_cast<double>(pages) * static_cast<double>(page);
}

double memory_available() {
  std::ifstream lines("/proc/meminfo");
  for (std::string line; std::getline(lines, line);) {
    long kilobytes = 0;
    if (std::sscanf(line.c_str(), "MemAvailable: %ld kB", &kilobytes) == 1)
      return 1024.0 * static_cast<double>(kilobytes);
  }
  return memory_of_machine();
}

std::string memory_text(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.3g} MB", bytes / 1e6) : fmt::format("{:.3g} GB", bytes / 1e9);
}

}  // namespace talus
