// One run of one discrete code, ready to be made: what the reference generator needs to know of it, whatever the case.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace talus::dem {

/// The functions take the run's folder.
struct PlannedRun {
  std::string case_name;   // "column_collapse"
  std::string point_name;  // of the case's parameters, "a_2"
  std::string code;        // "liggghts" or "yade"
  std::uint64_t seed;
  std::string version;               // of the code
  std::vector<std::string> command;  // to be run in the folder, on one core
  std::string log_file;
  double time_limit;  // s, wall clock
  /// Everything that decides the result goes into files here: their contents are the run's identity.
  std::function<void(const std::filesystem::path&)> write_input;
  std::function<double(const std::filesystem::path&)> progress;           // in [0, 1]
  std::function<std::string(const std::filesystem::path&)> failure_text;  // why it failed, from its logs
  /// Checks the output and reduces it to {"observables": {name: number}, "curves": {...}}: small, finite, SI
  /// units. Throws InputError for a leak, a loss, a damaged or missing file, a run that did not come to rest.
  std::function<nlohmann::json(const std::filesystem::path&)> measure;
};

}  // namespace talus::dem
