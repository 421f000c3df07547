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
  if (report.projection.cap_hits == 0 && report.packing.solve.converged) return;
  spdlog::warn("t = {:.4f} s: {} solves stopped at their iteration cap, not converged", state.time,
               report.projection.cap_hits + !report.packing.solve.converged);
}

void run(const std::filesystem::path& scene_file, const std::filesystem::path& output,
         const std::string& command_line) {
  const Scene scene = read_scene(scene_file);
  make_writable_folder(output);
  nlohmann::json made_by = provenance();
  made_by["command_line"] = command_line;
  made_by["input_hash"] = scene.input_hash;

  // Results of an earlier run there must not stand for this one's, should it not finish.
  for (const char* old : {"snapshots.h5", "snapshots.xdmf", "run.json"})
    std::filesystem::remove(output / old);

  State state = initial_state(scene);
  Budget budget(state);
  analysis::SnapshotWriter snapshots(output / "snapshots.h5", made_by.dump());
  snapshots.append(snapshot_of(state));
  const int frames = static_cast<int>(std::ceil(scene.end_time / scene.frame_interval - 1e-9));
  spdlog::info("{} particles, {} x {} x {} cells, {} frames", state.particles.count(), scene.grid.cells[0],
               scene.grid.cells[1], scene.grid.cells[2], frames);
  for (int frame = 1; frame <= frames; ++frame) {
    const double frame_end = std::min(frame * scene.frame_interval, scene.end_time);
    while (frame_end - state.time > 1e-9 * scene.frame_interval) {
      const StepReport report = step(state, scene.settings, frame_end - state.time);
      budget.add(state, report);
      warn_of_caps(state, report);
    }
    state.time = frame_end;
    snapshots.append(snapshot_of(state));
    spdlog::info("frame {}/{} t = {:.4f} s", frame, frames, state.time);
  }
  snapshots.finish();
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
  std::filesystem::path scene, output;
  auto* run_command =
      app.add_subcommand("run", "Run a scene to its end; writes snapshots.h5 (+ .xdmf) and run.json");
  run_command->add_option("scene", scene, "scene file (TOML)")->required();
  run_command->add_option("-o,--output", output, "folder for the results, made if need be")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : exit_input;
  }
  try {
    run(scene, output, fmt::format("{}", fmt::join(argv, argv + argc, " ")));
    return 0;
  } catch (const InputError& error) {
    fmt::print(stderr, "talus: {}\n", error.what());
    return exit_input;
  } catch (const std::exception& error) {
    fmt::print(stderr, "talus: {}\n", error.what());
    return exit_failed;
  }
}
