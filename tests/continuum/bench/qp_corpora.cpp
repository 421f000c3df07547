// Writes the quadratic programs of typical moments, for solvers to be compared on: qp_corpora FOLDER
//
// FOLDER gets a sub-folder for each moment, with every problem of the step that starts then, and a README.md that says what
// each is. Solve them with: qp_replay_bench FOLDER
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"
#include "continuum/files/provenance.h"
#include "continuum/qp/problem_file.h"
#include "continuum/scene/scene.h"

namespace talus {
namespace {

namespace fs = std::filesystem;

struct Moment {
  std::string name;  // of its sub-folder
  double time;       // s; the step that starts then is recorded
  std::string what;
};

struct Corpus {
  std::string scene;  // of tests/continuum/bench/corpora
  std::vector<Moment> moments;
};

const std::vector<Corpus> corpora{
    {"collapse",
     {{"cold_start", 0.0, "A cylinder of sand is let go: the first step, which starts from no stress."},
      {"full_flight", 0.2, "The same in full flight, while it spreads."},
      {"heap_at_rest", 1.0, "The heap it ends as, at rest."}}},
    {"hourglass", {{"hourglass", 0.15, "An hourglass, running: sand between walls that cut cells."}}},
    {"impact",
     {{"impact", 0.02, "A block of sand hits a bed at 1.5 m/s: the step in which they meet."},
      {"after_impact", 0.03, "The same a little later: the bed gives way."}}},
};

struct Options {
  fs::path folder;
  std::vector<std::string> only;  // moments; none means all
  int coarser = 1;                // cells so many times as long
};

bool wanted(const Options& options, const Moment& moment) {
  return options.only.empty() ||
         std::find(options.only.begin(), options.only.end(), moment.name) != options.only.end();
}

Scene scene_of(const Corpus& corpus, const Options& options) {
  Scene scene =
      read_scene(fs::path(TALUS_SOURCE_DIR "/tests/continuum/bench/corpora") / (corpus.scene + ".toml"));
  scene.grid.spacing *= options.coarser;
  scene.grid.cells = (scene.grid.cells.array() + options.coarser - 1) / options.coarser;
  return scene;
}

/// Runs a scene as far as the last moment that is wanted. Returns a line for each, for the README.
std::string record(const Corpus& corpus, const Options& options, const std::string& made_by) {
  if (std::none_of(corpus.moments.begin(), corpus.moments.end(),
                   [&](const Moment& moment) { return wanted(options, moment); }))
    return {};
  const Scene scene = scene_of(corpus, options);
  StepSettings settings = scene.settings;
  State state = initial_state(scene);
  std::string lines;
  int steps = 0;
  for (const Moment& moment : corpus.moments) {
    if (!wanted(options, moment)) continue;
    settings.projection.record = {};
    for (; state.time < moment.time * (1.0 - 1e-9); ++steps) step(state, settings, moment.time - state.time);
    settings.projection.record = record_step(options.folder / moment.name, steps, made_by);
    step(state, settings, scene.frame_interval);
    const int cells = state.warm ? state.warm->region.cell_count() : 0;
    lines += fmt::format("| `{}` | {} | {}.toml, {:.3g} s, step {} | {} | {} |\n", moment.name, moment.what,
                         corpus.scene, moment.time, steps, cells, state.particles.count());
    ++steps;
    fmt::print("{}: {} cells\n", moment.name, cells);
  }
  return lines;
}

void check_names(const Options& options) {
  for (const std::string& name : options.only) {
    if (std::none_of(corpora.begin(), corpora.end(), [&](const Corpus& corpus) {
          return std::any_of(corpus.moments.begin(), corpus.moments.end(),
                             [&](const Moment& moment) { return moment.name == name; });
        }))
      throw InputError(fmt::format("--only {}: there is no such corpus", name));
  }
}

/// What an earlier run left must not lie mixed with what this one writes.
void clear_old_problems(const fs::path& folder) {
  fs::remove(folder / "README.md");
  for (const Corpus& corpus : corpora) {
    for (const Moment& moment : corpus.moments) fs::remove_all(folder / moment.name / "qp");
  }
}

void write_corpora(const Options& options, const std::string& command_line) {
  check_names(options);
  make_writable_folder(options.folder);
  clear_old_problems(options.folder);
  nlohmann::json made_by = provenance();
  made_by["command_line"] = command_line;
  std::string readme = fmt::format("# Recorded quadratic programs\n\nMade by `{}`, {}.\n\n", command_line,
                                   version_line("qp_corpora")) +
                       "| folder | what | from | active cells | particles |\n|---|---|---|---|---|\n";
  for (const Corpus& corpus : corpora) readme += record(corpus, options, made_by.dump());
  write_file_atomically(options.folder / "README.md", readme);
}

}  // namespace
}  // namespace talus

int main(int argc, char** argv) {
  CLI::App app{"Writes the quadratic programs of typical moments, for solvers to be compared on."};
  talus::Options options;
  app.add_option("folder", options.folder,
                 "folder for a sub-folder for each moment, made if need be; old ones are replaced")
      ->required();
  app.add_option("--only", options.only, "a moment, by the name of its sub-folder; repeatable; default: all");
  app.add_option("--coarser", options.coarser, "cells so many times as long")->check(CLI::Range(1, 4));
  CLI11_PARSE(app, argc, argv);
  try {
    talus::write_corpora(options, fmt::format("{}", fmt::join(argv, argv + argc, " ")));
    return 0;
  } catch (const talus::InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
