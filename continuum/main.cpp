// talus: the continuum solver.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <limits>

#include "continuum/files/input_error.h"
#include "continuum/files/provenance.h"
#include "continuum/parallel.h"
#include "continuum/program/bench.h"
#include "continuum/program/run.h"

namespace {

using namespace talus;

constexpr int exit_input = 2;
constexpr int exit_failed = 1;
constexpr int most_threads = 1024;

CLI::App* add_run(CLI::App& app, RunOptions& options) {
  auto* command = app.add_subcommand(
      "run", "Run a scene to its end; writes snapshots.h5 (+ .xdmf), budget.csv (a row a step) and run.json");
  command->add_option("scene", options.scene, "scene file (TOML)")->required();
  command->add_option("-o,--output", options.output, "folder for the results, made if need be")->required();
  command
      ->add_option("--dump-qp", options.dumped_steps,
                   "step, from 0, whose quadratic programs are written to OUTPUT/qp/step_NNNNNN; repeatable")
      ->check(CLI::NonNegativeNumber);
  return command;
}

CLI::App* add_bench(CLI::App& app, BenchOptions& options) {
  auto* command = app.add_subcommand(
      "bench", "Run a scene without writing it, and tell what it cost: time by phase, iterations, memory");
  command->add_option("scene", options.scene, "scene file (TOML)")->required();
  command->add_option("--frames", options.frames, "frames to run, of the scene's interval; default: all")
      ->check(CLI::Range(1, std::numeric_limits<int>::max()));
  command->add_option("--json", options.json, "file for the figures, replaced if it is there");
  return command;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Talus: sand as a continuum that packs to a limit, never pulls, and resists shear by friction."};
  app.set_version_flag("--version", version_line("talus"));
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
  BenchOptions bench_options;
  run_options.command_line = bench_options.command_line =
      fmt::format("{}", fmt::join(argv, argv + argc, " "));
  int threads = 1;
  auto* run_command = add_run(app, run_options);
  auto* bench_command = add_bench(app, bench_options);
  for (CLI::App* command : {run_command, bench_command}) {
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
    if (*run_command)
      run(run_options);
    else
      bench(bench_options);
    return 0;
  } catch (const InputError& error) {
    fmt::print(stderr, "talus: {}\n", error.what());
    return exit_input;
  } catch (const std::exception& error) {
    fmt::print(stderr, "talus: {}\n", error.what());
    return exit_failed;
  }
}
