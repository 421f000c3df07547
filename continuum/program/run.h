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

/// Writes snapshots.h5, budget.csv, run.json, a copy of the scene as run.toml and the problems of the dumped steps to `output`;
/// render.h5 where the scene asks for render points; where there are bodies also bodies.csv (body_log.h) and bodies/NAME.stl:
/// the surface of each, in m, about its centre of mass and along its own axes. Throws InputError.
void run(const RunOptions& options);

}  // namespace talus
