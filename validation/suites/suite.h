// A suite: which cases run on which backends with which seeds, and how the continuum resolves them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "dem_cases/calibration.h"
#include "dem_cases/case.h"

namespace talus::validation {

/// Numerical resolution of the continuum; not a property of the case.
struct ContinuumResolution {
  int cells_per_column_length;  // L0 / h
  int particles_per_cell_axis;
  double lattice_jitter;  // fraction of the particle spacing
};

struct SuiteCase {
  dem::Case column;
  dem::MaterialConstants material;  // the continuum's, from the calibration
  std::vector<std::string> backends;
  std::vector<std::uint64_t> seeds;            // those of the case, unless the suite says otherwise
  double time_limit;                           // s, wall clock, of one run
  std::map<std::string, double> expected_cpu;  // s, by backend
};

struct Suite {
  std::string name;
  std::string title;
  std::filesystem::path file;
  std::string input_hash;  // SHA-256 of the file's text
  std::filesystem::path calibration;
  std::string calibration_hash;  // likewise
  ContinuumResolution resolution;
  std::vector<SuiteCase> cases;
};

/// `name_or_file`: the name of a suite in validation/suites, or the path of a suite file. Paths inside are
/// relative to the suite file. Reads and checks the suite and all its cases. Throws InputError.
Suite read_suite(const std::string& name_or_file);

/// Names of the suites that come with Talus.
std::vector<std::string> suite_names();

}  // namespace talus::validation
