// talus: the continuum solver.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <array>
#include <limits>
#include <optional>

#include "analysis/snapshot.h"
#include "continuum/files/input_error.h"
#include "continuum/files/provenance.h"
#include "continuum/parallel.h"
#include "continuum/program/bench.h"
#include "continuum/program/check.h"
#include "continuum/program/run.h"
#include "continuum/render/export.h"
#include "continuum/render/render.h"

namespace {

using namespace talus;

constexpr int exit_input = 2;
constexpr int exit_failed = 1;
constexpr int most_threads = 1024;

/// What `run` and `resume` take alike.
template <class Options>
void add_steps(CLI::App& command, Options& options, const std::string& folder) {
  command
      .add_option(
          "--dump-qp", options.dumped_steps,
          "step, from 0, whose quadratic programs are written to " + folder + "/qp/step_NNNNNN; repeatable")
      ->check(CLI::NonNegativeNumber);
  command
      .add_option(
          "--checkpoint-every", options.checkpoint_every,
          "seconds between checkpoints, by the clock on the wall, for talus resume; default: one when "
          "SIGINT or SIGTERM stops the run, and none else")
      ->check(CLI::NonNegativeNumber);
}

CLI::App* add_run(CLI::App& app, RunOptions& options) {
  auto* command = app.add_subcommand(
      "run",
      "Run a scene to its end; writes snapshots.h5 (+ .xdmf), budget.csv (a row a step) and run.json; "
      "render.h5 (+ .xdmf) if the scene asks for render points; bodies.csv and bodies/NAME.stl if it has "
      "bodies");
  command->add_option("scene", options.scene, "scene file (TOML)")->required();
  command->add_option("-o,--output", options.output, "folder for the results, made if need be")->required();
  add_steps(*command, options, "OUTPUT");
  command->add_flag("--discard", options.discard,
                    "start anew, though OUTPUT holds the checkpoint of an unfinished run");
  return command;
}

CLI::App* add_resume(CLI::App& app, ResumeOptions& options) {
  auto* command = app.add_subcommand("resume",
                                     "Go on with an unfinished run from its newest checkpoint; its results "
                                     "are those of a run without a stop");
  command->add_option("folder", options.folder, "folder of the run")->required();
  add_steps(*command, options, "FOLDER");
  command->add_flag("--other-solver", options.other_solver,
                    "go on though another version of this program began it");
  return command;
}

CLI::App* add_digest(CLI::App& app, std::filesystem::path& folder) {
  auto* command = app.add_subcommand("digest",
                                     "Print the SHA-256 of the final state of a run, to the last bit; of an "
                                     "unfinished one, of its checkpoint");
  command->add_option("folder", folder, "folder of the run")->required();
  return command;
}

CLI::App* add_check(CLI::App& app, CheckOptions& options) {
  auto* command = app.add_subcommand("check",
                                     "Tell all that is wrong or dangerous with scenes, and what they need, "
                                     "without running them; exit code 2 "
                                     "if one is not fit to run");
  command->add_option("scenes", options.scenes, "scene files (TOML)")->required();
  command->add_flag("--strict", options.strict, "warnings count as errors");
  return command;
}

CLI::App* add_bench(CLI::App& app, BenchOptions& options) {
  auto* command = app.add_subcommand(
      "bench", "Run a scene without writing it, and tell what it cost: time by phase, iterations, memory");
  command->add_option("scenes", options.scenes, "scene files (TOML)")->required();
  command->add_option("--frames", options.frames, "frames to run, of the scene's interval; default: all")
      ->check(CLI::Range(1, std::numeric_limits<int>::max()));
  command->add_option("--json", options.json, "file for the figures, replaced if it is there");
  return command;
}

/// Three numbers.
void add_vector(CLI::App& command, const std::string& name, std::optional<Eigen::Vector3d>& value,
                const std::string& what) {
  command
      .add_option_function<std::array<double, 3>>(
          name, [&value](const std::array<double, 3>& v) { value = Eigen::Vector3d(v[0], v[1], v[2]); }, what)
      ->type_name("X Y Z");
}

/// What `render` and `export` take alike.
template <class Options>
void add_drawn(CLI::App& command, Options& options, const std::string& folder) {
  command.add_option("run", options.run, "folder that a talus run wrote, with render.h5")->required();
  command.add_option("-o,--output", options.output,
                     "folder for the results, made if need be; default: RUN/" + folder);
  command.add_option("--frames", options.frames, "all, or a list like 0,5,10-20,30-last:3; default: all");
  command.add_option("--colour", options.colours, "a material's colour, as MATERIAL=#RRGGBB; repeatable")
      ->type_name("TEXT");
}

CLI::App* add_render(CLI::App& app, RenderOptions& options) {
  auto* command = app.add_subcommand(
      "render", "Draw a run's render points by POV-Ray: frame_NNNNNN.png, and with --film a film, by ffmpeg");
  add_drawn(*command, options, "pictures");
  command->add_option("--width", options.width, "of the picture, pixels; default 960")
      ->check(CLI::Range(16, 16384));
  command->add_option("--height", options.height, "of the picture, pixels; default 540")
      ->check(CLI::Range(16, 16384));
  command
      ->add_option("--samples", options.samples,
                   "rays along each axis of a pixel that differs from its neighbours; 1: none; default 2")
      ->check(CLI::Range(1, 9));
  add_vector(*command, "--camera", options.camera.position,
             "where from, m; default: so that all the sand is seen");
  add_vector(*command, "--look-at", options.camera.look_at,
             "the middle of the picture, m; default: the sand's middle");
  command
      ->add_option("--field-of-view", options.camera.field_of_view, "across the picture, degrees; default 35")
      ->check(CLI::Range(1.0, 150.0));
  add_vector(*command, "--sun", options.sun,
             "direction towards the sun; default: left of the viewer, 43 degrees high");
  command
      ->add_option("--sun-width", options.sun_width,
                   "degrees that the sun is wide, which softens shadows; default 4")
      ->check(CLI::Range(0.0, 60.0));
  command
      ->add_option("--point-size", options.point_size,
                   "of what is drawn for a point, to the size at which sand is just dense; default 1")
      ->check(CLI::Range(0.01, 100.0));
  command->add_option("--film", options.film, "name of a film in the output folder, ending in .mp4 or .webm");
  command->add_option("--pictures-per-second", options.pictures_per_second, "of the film; default 24")
      ->check(CLI::Range(0.1, 1000.0));
  command->add_flag("--keep-scenes", options.keep_scenes, "keep frame_NNNNNN.pov, what POV-Ray read");
  return command;
}

CLI::App* add_export(CLI::App& app, ExportOptions& options) {
  auto* command =
      app.add_subcommand("export", "Write a run's render points as files for other programs, one a frame");
  add_drawn(*command, options, "export");
  command
      ->add_option("--format", options.format,
                   "ply (Blender, MeshLab, CloudCompare) or vtk (.vtp files, with render.pvd for ParaView)")
      ->check(CLI::IsMember({"ply", "vtk"}))
      ->required();
  return command;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Talus: sand as a continuum that packs to a limit, never pulls, and resists shear by friction."};
  app.set_version_flag("--version", version_text("talus"));
  app.add_flag_callback(
         "--solver",
         [] {
           fmt::print("{}\n", solver_line());
           throw CLI::Success();
         },
         "print what decides the results and nothing else: runs of two programs that agree in it are the "
         "same")
      ->trigger_on_parse();
  app.require_subcommand(1);
  RunOptions run_options;
  ResumeOptions resume_options;
  BenchOptions bench_options;
  run_options.command_line = resume_options.command_line = bench_options.command_line =
      command_line_of(argc, argv);
  int threads = 1;
  auto* run_command = add_run(app, run_options);
  auto* resume_command = add_resume(app, resume_options);
  std::filesystem::path digest_folder;
  auto* digest_command = add_digest(app, digest_folder);
  auto* bench_command = add_bench(app, bench_options);
  CheckOptions check_options;
  auto* check_command = add_check(app, check_options);
  RenderOptions render_options;
  ExportOptions export_options;
  auto* render_command = add_render(app, render_options);
  auto* export_command = add_export(app, export_options);
  render_command->add_option("--threads", render_options.threads, "threads that POV-Ray uses; default 1")
      ->check(CLI::Range(1, most_threads));
  for (CLI::App* command : {run_command, resume_command, bench_command}) {
    command
        ->add_option("--threads", threads,
                     "threads to use, no more than there are idle processors, for they spin while they wait; "
                     "results do not depend on it; default 1")
        ->check(CLI::Range(1, most_threads));
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : exit_input;
  }
  set_thread_count(threads);
  try {
    if (*run_command) return run(run_options);
    if (*resume_command) return resume(resume_options);
    if (*digest_command) fmt::print("{}\n", digest(digest_folder));
    if (*check_command) check(check_options);
    if (*bench_command) bench(bench_options);
    if (*render_command) render(render_options);
    if (*export_command) export_points(export_options);
    return 0;
  } catch (const InputError& error) {
    fmt::print(stderr, "talus: {}\n", error.what());
    return exit_input;
  } catch (const analysis::SnapshotError& error) {  // a full disk, or a folder that is no longer there
    fmt::print(stderr, "talus: {}\n", error.what());
    return exit_input;
  } catch (const std::exception& error) {
    fmt::print(stderr, "talus: {}\n", error.what());
    return exit_failed;
  }
}
