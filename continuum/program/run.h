// `talus run`: a scene to its end, with its results on disk.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace talus {

struct RunOptions {
  std::filesystem::path scene, output;
  std::vector<int> dumped_steps;  // counted from 0
  std::string command_line;
};

/// Writes snapshots.h5, budget.csv, run.json, a copy of the scene as run.toml, render.h5 where the scene asks for render
/// points, and the problems of the dumped steps to `output`. Throws InputError.
void run(const RunOptions& options);

}  // namespace talus
