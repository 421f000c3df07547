// `talus bench`: what a scene costs to run, and where the time goes. Nothing but that is written.
//
// Times are those of the time loop alone, without reading the scene and making its particles: cpu_s is the process's user and
// system time, which all its threads add to, wall_s and the seconds of the phases are by the clock on the wall. Peak memory is
// the process's while it runs the scene.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace talus {

struct BenchOptions {
  std::vector<std::filesystem::path> scenes;
  std::optional<int> frames;                  // from the start; else to the scene's end
  std::optional<std::filesystem::path> json;  // where the figures go, beside the table
  std::string command_line;
};

/// Runs the scenes, one after the other, and prints a table for each, and for several one of all: beside those of the source's
/// table 5.1, where the scenes hold them. Throws InputError, before any has run.
void bench(const BenchOptions& options);

}  // namespace talus
