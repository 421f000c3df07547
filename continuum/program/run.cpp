#include "continuum/program/run.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "analysis/snapshot.h"
#include "continuum/files/atomic_file.h"
#include "continuum/files/provenance.h"
#include "continuum/io/body_log.h"
#include "continuum/io/budget.h"
#include "continuum/io/stl.h"
#include "continuum/parallel.h"
#include "continuum/program/check.h"
#include "continuum/program/frames.h"
#include "continuum/qp/problem_file.h"
#include "continuum/render/render_file.h"
#include "continuum/render/render_frame.h"
#include "continuum/solids/surface_mesh.h"

namespace talus {
namespace {

analysis::Snapshot snapshot_of(const State& state) {
  analysis::Snapshot snapshot{state.time, state.particles.positions, state.particles.velocities, {}};
  snapshot.volumes.resize(state.particles.count());
  for (Eigen::Index p = 0; p < state.particles.count(); ++p) {
    const auto material = static_cast<std::size_t>(state.particles.materials[static_cast<std::size_t>(p)]);
    snapshot.volumes[p] = state.particles.masses[p] / state.materials[material].grain_density;
  }
  return snapshot;
}

void warn_of_caps(const State& state, const StepReport& report) {
  if (report.cap_hits() == 0) return;
  spdlog::warn("t = {:.4f} s: {} solves stopped at their iteration cap, not converged", state.time,
               report.cap_hits());
}

/// A frame of everything that a run writes frame by frame.
class Frames {
 public:
  Frames(const std::filesystem::path& output, const RenderPoints& drawn, const std::string& made_by)
      : snapshots_(output / "snapshots.h5", made_by) {
    if (drawn.wanted()) pictures_.emplace(output / "render.h5", drawn.per_volume, made_by);
  }
  void append(const State& state) {
    snapshots_.append(snapshot_of(state));
    if (pictures_) pictures_->append(render_frame_of(state));
  }
  void finish() {
    snapshots_.finish();
    if (pictures_) pictures_->finish();
  }

 private:
  analysis::SnapshotWriter snapshots_;
  std::optional<RenderWriter> pictures_;
};

/// Results of an earlier run there must not stand for this one's, should it not finish.
void clear_old_results(const std::filesystem::path& output) {
  for (const char* old :
       {"snapshots.h5", "snapshots.xdmf", "render.h5", "render.xdmf", "run.json", "budget.csv", "bodies.csv"})
    std::filesystem::remove(output / old);
  if (std::filesystem::is_directory(output / "bodies")) {
    for (const auto& surface : std::filesystem::directory_iterator(output / "bodies")) {
      if (surface.path().extension() == ".stl") std::filesystem::remove(surface.path());
    }
  }
  if (!std::filesystem::is_directory(output / "qp")) return;
  for (const auto& step : std::filesystem::directory_iterator(output / "qp")) {
    if (step.path().filename().string().starts_with("step_")) std::filesystem::remove_all(step.path());
  }
}

/// Where there are bodies: their surfaces, and a row for each in every frame.
class BodyFiles {
 public:
  BodyFiles(const std::filesystem::path& output, const State& state) {
    if (state.bodies.empty()) return;
    std::filesystem::create_directories(output / "bodies");
    for (const Body& body : state.bodies)
      write_file_atomically(output / "bodies" / (body.name + ".stl"), binary_stl(surface_mesh(body.shape)));
    rows_.emplace(output / "bodies.csv", BodyLog::header() + log_.rows(state));
  }
  void add(const StepReport& report) { log_.add(report); }
  void end_frame(const State& state) {
    if (rows_) rows_->append(log_.rows(state));
  }
  void finish() {
    if (rows_) rows_->finish();
  }

 private:
  BodyLog log_;
  std::optional<GrowingFile> rows_;
};

}  // namespace

void run(const RunOptions& options) {
  const std::filesystem::path& output = options.output;
  const std::vector<int>& dumped_steps = options.dumped_steps;
  Scene scene = read_scene(options.scene);
  const std::string scene_text = read_file(options.scene);
  make_writable_folder(output);
  nlohmann::json made_by = provenance();
  made_by["command_line"] = options.command_line;
  made_by["input_hash"] = scene.input_hash;
  made_by["threads"] = thread_count();

  if (!scene.broken.empty()) made_by["broken"] = scene.broken;
  warn_if_broken(scene);
  warn_of_dangers(scene);

  clear_old_results(output);
  write_file_atomically(output / "run.toml", scene_text);
  State state = initial_state(scene);
  Budget budget(state);
  BodyFiles bodies(output, state);
  GrowingFile steps(output / "budget.csv", Budget::header());
  Frames frame_files(output, state.render_points, made_by.dump());
  frame_files.append(state);
  const int frames = frame_count(scene);
  spdlog::info("{} particles, {} x {} x {} cells, {} frames, {} threads", state.particles.count(),
               scene.grid.cells[0], scene.grid.cells[1], scene.grid.cells[2], frames, thread_count());
  int steps_done = 0;
  const auto take_step = [&](double dt_limit) {
    const bool dumped = std::find(dumped_steps.begin(), dumped_steps.end(), steps_done) != dumped_steps.end();
    scene.settings.projection.record =
        dumped ? record_step(output, steps_done, made_by.dump()) : ProblemRecorder{};
    const StepReport report = step(state, scene.settings, dt_limit);
    ++steps_done;
    budget.add(state, report);
    bodies.add(report);
    steps.append(budget.row());
    warn_of_caps(state, report);
  };
  for (int frame = 1; frame <= frames; ++frame) {
    run_to_frame(scene, frame, state, take_step);
    frame_files.append(state);
    bodies.end_frame(state);
    spdlog::info("frame {}/{} t = {:.4f} s", frame, frames, state.time);
  }
  for (const int dumped : dumped_steps) {
    if (dumped >= steps_done)
      spdlog::warn("no step {} to dump: the run took steps 0 to {}", dumped, steps_done - 1);
  }
  frame_files.finish();
  steps.finish();
  bodies.finish();
  nlohmann::json summary{{"schema", "talus-run"},
                         {"schema_version", 1},
                         {"provenance", made_by},
                         {"scene", options.scene.filename().string()},
                         {"scene_file", std::filesystem::absolute(options.scene).string()},
                         {"simulated_s", state.time},
                         {"particles", state.particles.count()},
                         {"budget", budget.summary()}};
  if (!scene.broken.empty()) summary["broken"] = scene.broken;
  write_file_atomically(output / "run.json", summary.dump(2) + "\n");
  spdlog::info("budget: {}", budget.summary().dump());
}

}  // namespace talus
