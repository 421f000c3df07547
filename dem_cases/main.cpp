// talus-dem: makes the reference ensemble of the discrete codes, and tells what it holds.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <csignal>
#include <iterator>
#include <map>
#include <set>
#include <thread>

#include "continuum/files/atomic_file.h"
#include "continuum/files/folder_lock.h"
#include "continuum/files/input_error.h"
#include "continuum/files/provenance.h"
#include "dem_cases/check.h"
#include "dem_cases/grain_dump.h"
#include "dem_cases/reference/make_run.h"
#include "dem_cases/reference/plan.h"
#include "dem_cases/reference/store.h"
#include "dem_cases/reference/table.h"
#include "dem_cases/shear_cell/calibrate.h"
#include "dem_cases/shear_cell/shear_cell.h"
#include "dem_cases/work_queue.h"

namespace {

using namespace talus;
using namespace talus::dem;

constexpr int exit_done = 0;
constexpr int exit_failed = 1;  // a run failed
constexpr int exit_input = 2;
constexpr int exit_interrupted = 130;

std::atomic<bool> interrupted = false;
extern "C" void interrupt(int) { interrupted = true; }

struct Arguments {
  std::filesystem::path reference = reference_folder();
  std::filesystem::path runs = "build/reference";
  std::vector<std::string> cases;  // names of cases, CASE/POINT, or case files; empty: all
  std::string code;                // empty: both
  std::filesystem::path output;    // of calibrate; empty: stdout
  int workers = 0;
  bool strict = false;  // of check: warnings count as errors
};

bool is_case_file(const std::string& name) { return name.ends_with(".toml"); }

/// What one name selects: a case file, a case that comes with Talus, or one point of it.
std::vector<PlannedRun> runs_called(const std::string& name) {
  if (is_case_file(name)) return planned_runs_of_file(name);
  auto runs = all_planned_runs();
  std::erase_if(runs, [&](const PlannedRun& run) {
    return name != run.case_name && name != run.case_name + "/" + run.point_name;
  });
  if (runs.empty()) {
    throw InputError(fmt::format(
        "'{}': there is no such case, or CASE/POINT; 'talus-dem list' tells them. A case file's name ends "
        "in .toml",
        name));
  }
  return runs;
}

std::vector<PlannedRun> wanted_runs(const Arguments& arguments) {
  std::vector<PlannedRun> runs;
  if (arguments.cases.empty()) runs = all_planned_runs();
  for (const std::string& name : arguments.cases)
    std::ranges::move(runs_called(name), std::back_inserter(runs));
  std::erase_if(runs,
                [&](const PlannedRun& run) { return !arguments.code.empty() && run.code != arguments.code; });
  std::set<std::string> seen;  // a run that two names select is one run
  std::erase_if(runs, [&](const PlannedRun& run) { return !seen.insert(label(run)).second; });
  return runs;
}

/// The committed ensemble is for the cases that come with Talus.
void check_reference(const Arguments& arguments) {
  const bool own_files = std::ranges::any_of(arguments.cases, is_case_file);
  if (own_files && arguments.reference == reference_folder()) {
    throw InputError(
        "a case file of your own needs a reference of its own: give --reference FOLDER; without it records "
        "go to the "
        "ensemble of the cases that come with Talus");
  }
}

/// A run and where it is made.
struct Prepared {
  PlannedRun run;
  std::filesystem::path folder;
  std::string input_hash;
};

/// Those of the runs that the reference does not hold yet, with their inputs written.
std::vector<Prepared> missing_runs(const Arguments& arguments, std::vector<PlannedRun> wanted) {
  std::vector<Prepared> missing;
  for (PlannedRun& run : wanted) {
    if (interrupted) break;
    const auto folder = run_folder(arguments.runs, run).string() + ".partial";
    const std::string input_hash = prepare_run(run, folder);
    if (find_record(arguments.reference, run, input_hash)) {
      std::filesystem::remove_all(folder);
    } else {
      missing.push_back({std::move(run), folder, input_hash});
    }
  }
  return missing;
}

int make(const Arguments& arguments) {
  check_reference(arguments);
  auto wanted = wanted_runs(arguments);
  const FolderLock runs_lock(arguments.runs), reference_lock(arguments.reference);
  const auto missing = missing_runs(arguments, std::move(wanted));
  const int workers = arguments.workers > 0
                          ? arguments.workers
                          : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const auto stop = [] { return interrupted.load(); };
  std::vector<QueuedJob> queue;
  double cost = 0.0;
  for (const Prepared& prepared : missing) {
    cost += prepared.run.expected_cpu;
    queue.push_back({.label = label(prepared.run),
                     .expected_cpu = prepared.run.expected_cpu,
                     .run =
                         [&] {
                           const auto record =
                               make_run(prepared.run, prepared.folder, prepared.input_hash, stop);
                           store_record(arguments.reference, record);
                           write_file_atomically(prepared.folder / "record.json", record.dump(1) + "\n");
                           // Its numbers stand in snapshots.h5, compressed.
                           std::filesystem::remove(prepared.folder / dump_file);
                           const auto folder = run_folder(arguments.runs, prepared.run);
                           std::filesystem::remove_all(folder);
                           std::filesystem::rename(prepared.folder, folder);
                         },
                     .progress = [&] { return prepared.run.progress(prepared.folder); }});
  }
  spdlog::info("{} runs to make, about {:.0f} CPU-s, {} at a time", queue.size(), cost, workers);
  const int failures = run_side_by_side(queue, workers, stop);
  if (interrupted) {
    fmt::print(stderr, "talus-dem: interrupted; finished runs are stored, the same command makes the rest\n");
    return exit_interrupted;
  }
  if (failures > 0) {
    fmt::print(stderr, "talus-dem: {} of {} runs failed, as told above; the others are stored\n", failures,
               queue.size());
    return exit_failed;
  }
  return exit_done;
}

/// Whether the reference holds this very run, or one of its name that was made of other inputs.
const char* state_of(const std::filesystem::path& reference, const PlannedRun& run) {
  if (current_record(reference, run)) return "stored";
  const auto records = read_records(reference, run.case_name, run.point_name);
  const bool named = std::ranges::any_of(records, [&](const nlohmann::json& record) {
    return record.at("code") == run.code && record.at("seed") == run.seed;
  });
  return named ? "stale" : "missing";
}

int list(const Arguments& arguments) {
  for (const PlannedRun& run : wanted_runs(arguments)) {
    fmt::print("{:<60} {:>7.0f} CPU-s  {}\n", label(run), run.expected_cpu,
               state_of(arguments.reference, run));
  }
  return exit_done;
}

/// Reads all files, whatever is wrong with the first.
int check(const Arguments& arguments) {
  std::size_t unfit = 0;
  for (const std::string& file : arguments.cases) {
    const CaseCheck found = check_case_file(file);
    for (const auto& fault : found.faults) fmt::print("error: {}\n", fault);
    for (const auto& warning : found.warnings) fmt::print("warning: {}\n", warning);
    for (const auto& need : found.needs) fmt::print("{}\n", need);
    unfit += !found.faults.empty() || (arguments.strict && !found.warnings.empty()) ? 1 : 0;
  }
  if (unfit > 0)
    throw InputError(fmt::format("{} of {} case files are not fit to run", unfit, arguments.cases.size()));
  return exit_done;
}

int table(const Arguments& arguments) {
  fmt::print("{}\nDischarge of the slots, W = C rho_b sqrt(g) w (D - k d)^(3/2), LIGGGHTS:\n\n{}",
             reference_table(arguments.reference), beverloo_table(arguments.reference, slot_case_file()));
  if (arguments.reference != reference_folder()) return exit_done;
  std::map<std::string, int> count;
  for (const PlannedRun& run : all_planned_runs()) ++count[state_of(arguments.reference, run)];
  fmt::print(
      "\nOf the planned runs {} are stored, {} more are stored of other inputs than now (stale), {} are "
      "missing; 'talus-dem list' names them.\n",
      count["stored"], count["stale"], count["missing"]);
  return exit_done;
}

int calibrate_materials(const Arguments& arguments) {
  const ShearCell cell = read_shear_cell(shear_cell_file());
  std::vector<nlohmann::json> records;
  for (const PlannedRun& run : shear_cell_runs(cell)) {
    if (!arguments.code.empty() && run.code != arguments.code) continue;
    const auto record = current_record(arguments.reference, run);
    if (!record) {
      throw InputError(
          fmt::format("{}: the run '{}' is not stored, or was made of other inputs; make it with "
                      "'talus-dem run {}'",
                      arguments.reference.string(), label(run), cell.name));
    }
    records.push_back(*record);
  }
  const std::string text = calibrate(cell, records);
  if (arguments.output.empty())
    fmt::print("{}", text);
  else
    write_file_atomically(arguments.output, text);
  return exit_done;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Makes the reference ensemble: every case through LIGGGHTS and YADE, at its parameter points and "
      "seeds."};
  app.set_version_flag("--version", version_text("talus-dem"));
  app.require_subcommand(1);
  app.footer("Exit codes: 0 done, 1 a run failed, 2 bad input, 130 interrupted.");
  Arguments arguments;
  const auto add_selection = [&](CLI::App* command) {
    command->add_option("cases", arguments.cases,
                        "names of cases, CASE/POINT, or case files; without any: all");
    command->add_option("--code", arguments.code, "only this one; default: both")
        ->check(CLI::IsMember({"liggghts", "yade"}));
  };
  app.add_option("--reference", arguments.reference, "folder of the stored ensemble")->capture_default_str();
  auto* run_command =
      app.add_subcommand("run", "Make the runs that the ensemble lacks, or whose inputs have changed since");
  add_selection(run_command);
  run_command->add_option("--runs", arguments.runs, "folder in which runs are made, and their snapshots kept")
      ->capture_default_str();
  run_command->add_option("-j,--jobs", arguments.workers, "runs at a time, one core each; default: all cores")
      ->check(CLI::Range(1, 1024));
  auto* list_command =
      app.add_subcommand("list", "List all runs, with what they cost and whether they are stored");
  add_selection(list_command);
  auto* check_command = app.add_subcommand("check",
                                           "Tell all that is wrong or dangerous with case files, and what "
                                           "they need, without running a code; exit code 2 if "
                                           "one is not fit to run");
  check_command->add_option("files", arguments.cases, "case files")->required();
  check_command->add_flag("--strict", arguments.strict, "warnings count as errors");
  auto* table_command = app.add_subcommand(
      "table", "The stored ensemble: mean, spread and number of runs, both codes side by side");
  auto* calibrate_command = app.add_subcommand(
      "calibrate",
      "The continuum's material constants, as calibration.toml, from the stored runs of the shear cell");
  calibrate_command
      ->add_option("--code", arguments.code,
                   "runs of this one only, where the other's are not made yet; the file says which were used")
      ->check(CLI::IsMember({"liggghts"}));
  calibrate_command->add_option("-o,--output", arguments.output, "file to write; default: standard output");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_done : exit_input;
  }
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    if (std::signal(signal, interrupt) == SIG_IGN) std::signal(signal, SIG_IGN);  // nohup
  }
  try {
    if (*run_command) return make(arguments);
    if (*list_command) return list(arguments);
    if (*check_command) return check(arguments);
    if (*calibrate_command) return calibrate_materials(arguments);
    if (*table_command) return table(arguments);
  } catch (const InputError& error) {
    fmt::print(stderr, "talus-dem: {}\n", error.what());
    return exit_input;
  } catch (const std::exception& error) {
    fmt::print(stderr, "talus-dem: {}\n", error.what());
    return exit_failed;
  }
  return exit_input;
}
