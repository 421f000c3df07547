// One run of one discrete code, ready to be made: what the reference generator needs to know of it, whatever the case.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
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
  std::filesystem::path
      program{};  // what is started in place of command[0], where that is not its path: it may lie anywhere
  std::string log_file;
  double expected_cpu;  // s, roughly: the longest run starts first
  double time_limit;    // s, wall clock
  /// What decides the measuring, rather than the run: bins, windows, tolerances, and a version of the ruler. With the command and
  /// the files of write_input() it is the run's identity.
  nlohmann::json measurement;
  std::function<void(const std::filesystem::path&)> write_input;
  std::function<double(const std::filesystem::path&)> progress;           // in [0, 1]
  std::function<std::string(const std::filesystem::path&)> failure_text;  // why it failed, from its logs
  /// Checks the output and reduces it to {"observables": {name: number}, "curves": {name: [numbers]}}, SI units, a
  /// few thousand numbers at most. Throws InputError for a leak, a loss, a damaged or missing file, a run that did not come to rest.
  std::function<nlohmann::json(const std::filesystem::path&)> measure;
};

/// "column_collapse a_2 yade seed 1"
inline std::string label(const PlannedRun& run) {
  return run.case_name + " " + run.point_name + " " + run.code + " seed " + std::to_string(run.seed);
}

}  // namespace talus::dem
