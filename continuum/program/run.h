// `talus run`: a scene to its end, with its results on disk. `talus resume`: an unfinished run, from its checkpoint. `talus digest`:
// a name for the state that a run has come to.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace talus {

struct RunOptions {
  std::filesystem::path scene, output;
  std::vector<int> dumped_steps;           // counted from 0
  std::optional<double> checkpoint_every;  // s, by the clock on the wall
  bool discard = false;  // start anew, whatever checkpoint of an unfinished run is in `output`
  std::string command_line;
};

/// Writes snapshots.h5, budget.csv, run.json, a copy of the scene as run.toml and the problems of the dumped steps to `output`;
/// render.h5 where the scene asks for render points; where there are bodies also bodies.csv (body_log.h) and bodies/NAME.stl:
/// the surface of each, in m, about its centre of mass and along its own axes.
///
/// SIGINT and SIGTERM end it after the step it is in, with a checkpoint: then 128 + the signal's number is returned, else 0. Throws
/// InputError; throws NumericalError where a step cannot be taken, with the step and the folder, output/fault, from which it can be
/// tried again.
int run(const RunOptions& options);

struct ResumeOptions {
  std::filesystem::path folder;
  std::vector<int> dumped_steps;
  std::optional<double> checkpoint_every;
  bool other_solver = false;  // though another program began it, whose results may differ
  std::string command_line;
};

/// Goes on from the newest checkpoint in the folder; what comes of it is what the run would have come to without a stop, bit for bit.
/// As `run` otherwise. Throws InputError, too, when there is nothing to go on from, or the scene is no longer the one it was.
int resume(const ResumeOptions& options);

/// SHA-256 of the final state of the run in a folder; of an unfinished one, that of its checkpoint. Throws InputError.
std::string digest(const std::filesystem::path& folder);

}  // namespace talus
