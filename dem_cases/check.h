// What is wrong or dangerous with a case file, told without writing a deck or starting a code.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "continuum/files/faults.h"
#include "dem_cases/case.h"

namespace talus::dem {

inline constexpr double least_opening_diameters = 6.0;  // grains arch over narrower ones, and the flow stops
inline constexpr double fewest_grains = 500.0;          // of fewer, figures scatter by more than codes differ

struct CaseCheck {
  Faults faults;  // what read_case, read_shear_cell and check_time_step refuse, of all points
  std::vector<std::string> warnings;  // a line each
  std::vector<std::string>
      needs;  // a line for each point: grains, memory, steps, the time step against its limits
};

/// Of a case file with all its points, or of a shear cell.
CaseCheck check_case_file(const std::filesystem::path& file);

/// About what memory either code needs for a point, bytes: what they start with, and 10 kB a grain (seen: YADE with 18,450
/// grains 0.36 GB, LIGGGHTS with 11,300 and their floor 0.085 GB).
double expected_memory(const Case& a_case);

/// Of one point. `memory`: bytes that are free.
std::vector<std::string> case_warnings(const Case& a_case, double memory);

}  // namespace talus::dem
