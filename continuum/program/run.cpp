#include "continuum/program/run.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "continuum/files/atomic_file.h"
#include "continuum/files/folder_lock.h"
#include "continuum/files/input_error.h"
#include "continuum/files/provenance.h"
#include "continuum/io/budget.h"
#include "continuum/io/checkpoint.h"
#include "continuum/io/state_archive.h"
#include "continuum/parallel.h"
#include "continuum/program/check.h"
#include "continuum/program/frames.h"
#include "continuum/program/run_files.h"
#include "continuum/program/stop_signals.h"
#include "continuum/qp/problem_file.h"

namespace talus {
namespace {

using Path = std::filesystem::path;
using Clock = std::chrono::steady_clock;

/// At most so many lie between the state that output/fault has and the fault.
constexpr int steps_to_fault = 16;

void warn_of_caps(const State& state, const StepReport& report) {
  if (report.stagnations > 0)
    spdlog::warn("t = {:.4f} s: the solves stagnated; the step was taken again, {} times, with half the time",
                 state.time, report.stagnations);
  if (report.cap_hits() == 0) return;
  spdlog::warn("t = {:.4f} s: {} solves stopped at their iteration cap, not converged", state.time,
               report.cap_hits());
}

/// The scene that a run is of: where it was read, unless it has changed there, else the copy in the run's folder.
Path scene_file_of(const Path& folder, const RunIdentity& identity) {
  const Path copy = folder / "run.toml";
  for (const Path& file : {Path(identity.scene_file), copy}) {
    if (std::filesystem::is_regular_file(file) && sha256(read_file(file)) == identity.input_hash) return file;
  }
  throw InputError(fmt::format("{}: not the scene that the unfinished run is of", copy.string()));
}

RunIdentity identity_of(const Scene& scene, const std::string& command_line) {
  return {utf8(std::filesystem::absolute(scene.file).string()), scene.input_hash, solver_line(),
          command_line};
}

/// A run at work.
struct Running {
  Path output;
  Scene scene;
  RunIdentity identity;
  nlohmann::json made_by;
  std::vector<int> dumped_steps;
  std::optional<double> checkpoint_every;
  State state;
  Budget budget;
  BodyLog body_log;
  RunProgress progress;
};

/// The surface as the scene reads it, by name; the scene's own hash knows its file's name alone.
std::string mesh_hash(const Mesh& mesh) {
  std::string bytes;
  for (const Triangle& triangle : triangles_of(mesh)) {
    for (const Eigen::Vector3d& corner : triangle)
      bytes.append(reinterpret_cast<const char*>(corner.data()), sizeof(Eigen::Vector3d));
  }
  return sha256(bytes);
}

/// Of all meshes of a scene, in its order.
nlohmann::json mesh_hashes(const Scene& scene) {
  nlohmann::json hashes = nlohmann::json::array();
  const auto add = [&](const Shape& shape) {
    if (const auto* mesh = std::get_if<Mesh>(&shape.geometry)) hashes.push_back(mesh_hash(*mesh));
  };
  for (const Wall& wall : scene.walls) add(wall.shape);
  for (const Filling& filling : scene.fillings) add(filling.shape);
  for (const Body& body : scene.bodies) add(body.shape);
  return hashes;
}

nlohmann::json made_by(const Scene& scene, const RunIdentity& identity) {
  nlohmann::json made = provenance();
  made["command_line"] = identity.command_line;
  made["input_hash"] = identity.input_hash;
  made["mesh_hashes"] = mesh_hashes(scene);
  made["solver"] = identity.solver;
  made["threads"] = thread_count();
  if (!scene.broken.empty()) made["broken"] = scene.broken;
  return made;
}

void save(Running& run, RunFiles& files) {
  const int steps = run.progress.steps;
  run.progress = files.save();
  run.progress.steps = steps;
  write_checkpoint(run.output,
                   make_checkpoint(run.identity, run.progress, run.state, run.budget, run.body_log));
}

/// Lays down the state from which the step that failed can be tried again.
Path keep_fault(const Running& run, Checkpoint before) {
  Path folder = run.output / "fault";
  make_writable_folder(folder);
  write_file_atomically(folder / "run.toml", read_file(run.output / "run.toml"));
  before.progress.parts = 0;  // nothing of what has been written belongs to it
  before.progress.budget_bytes = before.progress.bodies_bytes = 0;
  remove_checkpoints(folder);
  write_checkpoint(folder, before);
  return folder;
}

/// A step with all that goes with it: books, files, checkpoints that are due, and what is kept should it fail.
class Stepper {
 public:
  Stepper(Running& run, RunFiles& files) : run_(run), files_(files), saved_(Clock::now()) {}

  /// False after a signal.
  bool take_step(double dt_limit) {
    if (run_.progress.steps % steps_to_fault == 0 || !before_.has_value())
      before_ = make_checkpoint(run_.identity, run_.progress, run_.state, run_.budget, run_.body_log);
    const StepReport report = step_or_fault(dt_limit);
    ++run_.progress.steps;
    run_.budget.add(run_.state, report);
    run_.body_log.add(report);
    files_.add_step(run_.budget.row());
    warn_of_caps(run_.state, report);
    if (StopSignals::received() != 0) return false;
    const double since = std::chrono::duration<double>(Clock::now() - saved_).count();
    if (run_.checkpoint_every && since >= *run_.checkpoint_every) {
      save(run_, files_);
      saved_ = Clock::now();
    }
    return true;
  }

 private:
  StepReport step_or_fault(double dt_limit) {
    const auto& dumped = run_.dumped_steps;
    const bool record = std::find(dumped.begin(), dumped.end(), run_.progress.steps) != dumped.end();
    run_.scene.settings.projection.record =
        record ? record_step(run_.output, run_.progress.steps, run_.made_by.dump()) : ProblemRecorder{};
    try {
      return step(run_.state, run_.scene.settings, dt_limit);
    } catch (const NumericalError& error) {
      const int steps_before = run_.progress.steps - before_->progress.steps;
      const Path folder = keep_fault(run_, *before_);
      throw NumericalError(fmt::format(
          "step {}: {}. The state {} steps before is in {}; to try again: talus resume {} --dump-qp {}",
          run_.progress.steps, error.what(), steps_before, folder.string(), folder.string(),
          run_.progress.steps));
    }
  }

  Running& run_;
  RunFiles& files_;
  Clock::time_point saved_;
  std::optional<Checkpoint> before_;
};

void write_summary(const Running& run) {
  nlohmann::json summary{{"schema", "talus-run"},
                         {"schema_version", 1},
                         {"provenance", run.made_by},
                         {"scene", utf8(run.scene.file.filename().string())},
                         {"scene_file", run.identity.scene_file},
                         {"simulated_s", run.state.time},
                         {"particles", run.state.particles.count()},
                         {"state_digest", digest_of(run.state)},
                         {"budget", run.budget.summary()}};
  if (!run.scene.broken.empty()) summary["broken"] = run.scene.broken;
  write_file_atomically(run.output / "run.json", summary.dump(2) + "\n");
  spdlog::info("budget: {}", run.budget.summary().dump());
}

/// From where the run is to its end.
int carry_on(Running& run) {
  const StopSignals signals;
  warn_if_broken(run.scene);
  RunFiles files(run.output, run.state, run.made_by.dump(), run.progress);
  Stepper stepper(run, files);
  const int frames = frame_count(run.scene);
  const auto add_frame = [&] {
    files.add_frame(run.state, run.body_log.rows(run.state));
    ++run.progress.frames;
  };
  if (run.progress.frames == 0) add_frame();
  spdlog::info("{} particles, {} x {} x {} cells, {} frames, {} threads", run.state.particles.count(),
               run.scene.grid.cells[0], run.scene.grid.cells[1], run.scene.grid.cells[2], frames,
               thread_count());
  while (run.progress.frames <= frames) {
    const int frame = run.progress.frames;
    if (!run_to_frame(run.scene, frame, run.state, [&](double dt) { return stepper.take_step(dt); })) {
      save(run, files);
      spdlog::info("stopped at t = {:.6g} s, after step {}; to go on: talus resume {}", run.state.time,
                   run.progress.steps - 1, run.output.string());
      return 128 + StopSignals::received();
    }
    add_frame();
    spdlog::info("frame {}/{} t = {:.4f} s", frame, frames, run.state.time);
  }
  for (const int dumped : run.dumped_steps) {
    if (dumped >= run.progress.steps)
      spdlog::warn("no step {} to dump: the run took steps 0 to {}", dumped, run.progress.steps - 1);
  }
  files.finish();
  write_summary(run);
  remove_traces(run.output);
  return 0;
}

bool finished(const Path& folder) { return std::filesystem::exists(folder / "run.json"); }

}  // namespace

int run(const RunOptions& options) {
  const Scene scene = read_scene(options.scene);
  const std::string scene_text = read_file(options.scene);
  State state = initial_state(scene);  // it may refuse the scene: nothing has been cleared away then
  const FolderLock lock(options.output);
  if (has_checkpoint(options.output) && !finished(options.output) && !options.discard) {
    throw InputError(fmt::format(
        "{0}: holds the checkpoint of an unfinished run; go on with it by talus resume {0}, or give "
        "--discard to start anew without it",
        options.output.string()));
  }
  warn_of_dangers(scene);
  clear_old_results(options.output);
  write_file_atomically(options.output / "run.toml", scene_text);
  const RunIdentity identity = identity_of(scene, options.command_line);
  Budget budget(state);
  Running running{options.output,
                  scene,
                  identity,
                  made_by(scene, identity),
                  options.dumped_steps,
                  options.checkpoint_every,
                  std::move(state),
                  budget,
                  {},
                  {}};
  return carry_on(running);
}

int resume(const ResumeOptions& options) {
  const Path& folder = options.folder;
  if (!std::filesystem::is_directory(folder))
    throw InputError(fmt::format("{}: no such folder; give that of an unfinished run", folder.string()));
  const FolderLock lock(folder);
  if (finished(folder)) throw InputError(fmt::format("{}: the run is finished", folder.string()));
  std::string told;
  Checkpoint checkpoint = read_checkpoint(folder, told);
  if (!told.empty()) spdlog::warn("{}; going on from the checkpoint before", told);
  if (checkpoint.identity.solver != solver_line() && !options.other_solver) {
    throw InputError(fmt::format(
        "{}: begun by another solver, \"{}\"; this is \"{}\". What comes of it may not be what either would "
        "give; --other-solver goes on all the same",
        folder.string(), checkpoint.identity.solver, solver_line()));
  }
  const Scene scene = read_scene(scene_file_of(folder, checkpoint.identity));
  State state = initial_state(scene);
  const std::string where = (folder / checkpoint_name).string();
  restore(checkpoint.state, where, state);
  Budget budget(checkpoint.budget, where, state);
  BodyLog body_log;
  body_log.restore(checkpoint.body_log, where);
  nlohmann::json made = made_by(scene, checkpoint.identity);
  made["resumed_by"] = options.command_line;
  Running running{folder,
                  scene,
                  checkpoint.identity,
                  made,
                  options.dumped_steps,
                  options.checkpoint_every,
                  std::move(state),
                  budget,
                  body_log,
                  checkpoint.progress};
  spdlog::info("going on at t = {:.6g} s, before step {}", running.state.time, running.progress.steps);
  return carry_on(running);
}

std::string digest(const Path& folder) {
  if (finished(folder)) {
    const Path file = folder / "run.json";
    try {
      return nlohmann::json::parse(read_file(file)).at("state_digest").get<std::string>();
    } catch (const nlohmann::json::exception& error) {
      throw InputError(
          fmt::format("{}: not a summary that this talus run writes: {}", file.string(), error.what()));
    }
  }
  std::string told;
  return digest_of_fields(read_checkpoint(folder, told).state);
}

}  // namespace talus
