// talus: the continuum solver.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "analysis/snapshot.h"
#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "continuum/files/provenance.h"
#include "continuum/io/budget.h"
#include "continuum/qp/problem_file.h"
#include "continuum/scene/scene.h"

namespace {

using namespace talus;

constexpr int exit_input = 2;
constexpr int exit_failed = 1;

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

struct RunOptions {
  std::filesystem::path scene, output;
  std::vector<int> dumped_steps;  // counted from 0
  std::string command_line;
};

/// Results of an earlier run there must not stand for this one's, should it not finish.
void clear_old_results(const std::filesystem::path& output) {
  for (const char* old : {"snapshots.h5", "snapshots.xdmf", "run.json", "budget.csv"})
    std::filesystem::remove(output / old);
  if (!std::filesystem::is_directory(output / "qp")) return;
  for (const auto& step : std::filesystem::directory_iterator(output / "qp")) {
    if (step.path().filename().string().starts_with("step_")) std::filesystem::remove_all(step.path());
  }
}

void run(const RunOptions& options) {
  const auto& [scene_file, output, dumped_steps, command_line] = options;
  Scene scene = read_scene(scene_file);
  make_writable_folder(output);
  nlohmann::json made_by = provenance();
  made_by["command_line"] = command_line;
  made_by["input_hash"] = scene.input_hash;

  clear_old_results(output);
  State state = initial_state(scene);
  Budget budget(state);
  GrowingFile steps(output / "budget.csv", Budget::header());
  analysis::SnapshotWriter snapshots(output / "snapshots.h5", made_by.dump());
  snapshots.append(snapshot_of(state));
  const int frames = static_cast<int>(std::ceil(scene.end_time / scene.frame_interval - 1e-9));
  spdlog::info("{} particles, {} x {} x {} cells, {} frames", state.particles.count(), scene.grid.cells[0],
               scene.grid.cells[1], scene.grid.cells[2], frames);
  int steps_done = 0;
  for (int frame = 1; frame <= frames; ++frame) {
    const double frame_end = std::min(frame * scene.frame_interval, scene.end_time);
    while (frame_end - state.time > 1e-9 * scene.frame_interval) {
      const bool dumped =
          std::find(dumped_steps.begin(), dumped_steps.end(), steps_done) != dumped_steps.end();
      scene.settings.projection.record =
          dumped ? record_step(output, steps_done, made_by.dump()) : ProblemRecorder{};
      const StepReport report = step(state, scene.settings, frame_end - state.time);
      ++steps_done;
      budget.add(state, report);
      steps.append(budget.row());
      warn_of_caps(state, report);
    }
    // A step that ended at an event just behind the frame's end stays there: going back would meet the event again.
    state.time = std::max(state.time, frame_end);
    snapshots.append(snapshot_of(state));
    spdlog::info("frame {}/{} t = {:.4f} s", frame, frames, state.time);
  }
  for (const int dumped : dumped_steps) {
    if (dumped >= steps_done)
      spdlog::warn("no step {} to dump: the run took steps 0 to {}", dumped, steps_done - 1);
  }
  snapshots.finish();
  steps.finish();
  const nlohmann::json summary{{"schema", "talus-run"},     {"schema_version", 1},
                               {"provenance", made_by},     {"scene", scene_file.filename().string()},
                               {"simulated_s", state.time}, {"particles", state.particles.count()},
                               {"budget", budget.summary()}};
  write_file_atomically(output / "run.json", summary.dump(2) + "\n");
  spdlog::info("budget: {}", budget.summary().dump());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Talus: sand as a continuum that packs to a limit, never pulls, and resists shear by friction."};
  app.set_version_flag("--version", version_line("talus"));
  app.require_subcommand(1);
  RunOptions options;
  options.command_line = fmt::format("{}", fmt::join(argv, argv + argc, " "));
  auto* run_command = app.add_subcommand(
      "run", "Run a scene to its end; writes snapshots.h5 (+ .xdmf), budget.csv (a row a step) and run.json");
  run_command->add_option("scene", options.scene, "scene file (TOML)")->required();
  run_command->add_option("-o,--output", options.output, "folder for the results, made if need be")
      ->required();
  run_command
      ->add_option("--dump-qp", options.dumped_steps,
                   "step, from 0, whose quadratic programs are written to OUTPUT/qp/step_NNNNNN; repeatable")
      ->check(CLI::NonNegativeNumber);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : exit_input;
  }
  try {
    run(options);
    return 0;
  } catch (const InputError& error) {
    fmt::print(stderr, "talus: {}\n", error.what());
    return exit_input;
  } catch (const std::exception& error) {
    fmt::print(stderr, "talus: {}\n", error.what());
    return exit_failed;
  }
}
