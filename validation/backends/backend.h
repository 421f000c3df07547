// One small interface to every code that can run a case: Case -> input in a folder -> command -> snapshots.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/snapshot.h"
#include "dem_cases/calibration.h"
#include "validation/suites/suite.h"

namespace talus::validation {

inline constexpr std::array<std::string_view, 3> backend_names{"continuum", "liggghts", "yade"};
/// The discrete codes, whose results together are the reference.
inline constexpr std::array<std::string_view, 2> reference_backends{"liggghts", "yade"};

/// What one run is asked.
struct RunRequest {
  const dem::Case& column;
  dem::MaterialConstants material;  // the continuum's, from the calibration
  ContinuumResolution resolution;
  std::uint64_t seed;
};

/// A backend, bound to one request. The functions take the run's folder.
struct Backend {
  std::string version;
  std::vector<std::string> command;
  std::string log_file;
  double thickness;          // m, of what it runs: a continuum in plane strain needs one cell only
  nlohmann::json preflight;  // checks made before the run; null where there are none
  std::function<void(const std::filesystem::path&)> write_input;
  std::function<double(const std::filesystem::path&)> progress;           // in [0, 1]
  std::function<std::string(const std::filesystem::path&)> failure_text;  // why it failed, from its logs
  std::function<analysis::SnapshotSeries(const std::filesystem::path&)> read_output;
  std::function<nlohmann::json(const std::filesystem::path&)> solver_summary;  // null for the discrete codes
};

/// Throws InputError when the backend's program is not installed or the request fails its preflight.
Backend make_backend(std::string_view name, const RunRequest& request);
Backend make_continuum_backend(const RunRequest& request);

}  // namespace talus::validation
