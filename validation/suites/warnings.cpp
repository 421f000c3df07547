#include "validation/suites/warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "continuum/files/memory.h"
#include "dem_cases/check.h"

namespace talus::validation {
namespace {

constexpr double bytes_of_mb = 1e6;

bool has_opening(const dem::Case& a_case) {
  return std::holds_alternative<dem::SlotGeometry>(a_case.geometry) ||
         std::holds_alternative<dem::HourglassGeometry>(a_case.geometry);
}

}  // namespace

std::vector<std::string> suite_warnings(const Suite& suite, const std::vector<SuiteRun>& runs,
                                        double memory) {
  std::vector<std::string> warnings;
  for (const SuitePoint& point : suite.points) {
    std::ranges::move(dem::case_warnings(point.a_case, memory), std::back_inserter(warnings));
    const int cells = point.resolution.cells;
    if (point.seeds.contains("continuum") && has_opening(point.a_case) && cells < least_cells_in_opening) {
      warnings.push_back(fmt::format(
          "{}: {}: key 'cells' = {} across the opening; fewer than {} let too little sand through",
          suite.file.string(), point.name(), cells, least_cells_in_opening));
    }
  }
  for (const SuiteRun& run : runs) {
    if (const double needed = bytes_of_mb * run.memory; needed > memory)
      warnings.push_back(fmt::format("{}: {}: needs about {} of memory; {} are free", suite.file.string(),
                                     run.name(), memory_text(needed), memory_text(memory)));
  }
  return warnings;
}

}  // namespace talus::validation
