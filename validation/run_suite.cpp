#include "validation/run_suite.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <map>

#include "continuum/files/atomic_file.h"
#include "continuum/files/folder_lock.h"
#include "continuum/files/input_error.h"
#include "continuum/files/process.h"
#include "dem_cases/check.h"
#include "dem_cases/grain_dump.h"
#include "dem_cases/reference/make_run.h"
#include "dem_cases/reference/plan.h"
#include "dem_cases/reference/store.h"
#include "dem_cases/time_step.h"
#include "dem_cases/work_queue.h"
#include "validation/backends/continuum.h"

namespace talus::validation {
namespace {

using nlohmann::json;

constexpr const char* record_name = "record.json";

std::filesystem::path partial(const SuiteRun& run) { return run.folder.string() + ".partial"; }

SuiteRun suite_run(const SuitePoint& point, dem::PlannedRun run, double memory,
                   const std::filesystem::path& output) {
  run.time_limit = point.time_limit;
  SuiteRun planned{point.name(), std::move(run), {}, memory, false};
  planned.folder = dem::run_folder(output / "runs", planned.run);
  return planned;
}

/// The continuum's runs of one point: those that are judged, and the refinement.
void add_continuum_runs(const SuitePoint& point, const Defects& defects, const std::filesystem::path& output,
                        std::vector<SuiteRun>& runs) {
  const auto add = [&](const char* code, const ContinuumResolution& resolution, std::uint64_t seed) {
    runs.push_back(suite_run(point,
                             continuum_run({.a_case = point.a_case,
                                            .material = point.material,
                                            .resolution = resolution,
                                            .seed = seed,
                                            .code = code,
                                            .defects = defects,
                                            .time_limit = point.time_limit}),
                             expected_continuum_memory(point.a_case, resolution), output));
  };
  const auto& seeds = point.seeds.at(continuum_code);
  for (const auto seed : seeds) add(continuum_code, point.resolution, seed);
  if (!point.refinement) return;
  ContinuumResolution coarse = point.resolution, short_steps = point.resolution;
  coarse.cells = point.resolution.cells / 2;
  short_steps.courant_factor = 0.5;
  add(coarse_code, coarse, seeds.front());
  add(short_steps_code, short_steps, seeds.front());
}

void add_discrete_runs(const SuitePoint& point, const std::filesystem::path& output,
                       std::vector<SuiteRun>& runs) {
  for (const auto& [code, seeds] : point.seeds) {
    if (code == continuum_code || seeds.empty()) continue;
    dem::check_time_step(point.a_case);
    for (const auto seed : seeds) {
      SuiteRun run = suite_run(point, dem::planned_run(point.a_case, code, seed),
                               dem::expected_memory(point.a_case) / 1e6, output);
      run.stored = point.stored;
      runs.push_back(std::move(run));
    }
  }
}

/// The record in the run's own folder, whatever it is of.
std::optional<json> own_record(const SuiteRun& run) {
  const auto file = run.folder / record_name;
  if (!std::filesystem::exists(file)) return std::nullopt;
  try {
    json record = json::parse(read_file(file));
    if (record.is_object()) return record;
    throw InputError(fmt::format("{}: not a record of a run; remove its folder", file.string()));
  } catch (const json::exception& error) {
    throw InputError(
        fmt::format("{}: not a record of a run: {}; remove its folder", file.string(), error.what()));
  }
}

std::optional<FoundRecord> find_record(const SuiteRun& run, const std::string& input_hash) {
  if (auto own = own_record(run);
      own && own->value("input_hash", "") == input_hash && own->value("version", "") == run.run.version) {
    return FoundRecord{std::move(*own), "run"};
  }
  if (run.stored) {
    if (auto record = dem::find_record(dem::reference_folder(), run.run, input_hash))
      return FoundRecord{std::move(*record), "ensemble"};
  }
  return std::nullopt;
}

/// Makes one run and puts its folder in place.
void make(const SuiteRun& run, const std::string& input_hash, const std::function<bool()>& stop) {
  // Another program that was asked for the same run must not take its folder away.
  const auto mine = run.folder.string() + ".lock";
  const FolderLock lock(mine);
  dem::prepare_run(run.run, partial(run));
  const json record = dem::make_run(run.run, partial(run), input_hash, stop);
  write_file_atomically(partial(run) / record_name, record.dump(1) + "\n");
  std::filesystem::remove(partial(run) / dem::dump_file);  // its numbers stand in snapshots.h5, compressed
  std::filesystem::remove_all(run.folder);
  std::filesystem::rename(partial(run), run.folder);
  std::filesystem::remove(mine);
}

}  // namespace

std::vector<SuiteRun> plan_runs(const Suite& suite, const std::filesystem::path& output,
                                const Defects& defects) {
  std::vector<SuiteRun> runs;
  for (const auto& point : suite.points) {
    if (point.seeds.contains(continuum_code)) add_continuum_runs(point, defects, output, runs);
    add_discrete_runs(point, output, runs);
  }
  return runs;
}

std::vector<SuiteRun> selected(const std::vector<SuiteRun>& runs, const std::vector<std::string>& only) {
  if (only.empty()) return runs;
  const auto selects = [](const std::string& name, const SuiteRun& run) {
    return run.name() == name || run.name().starts_with(name + "/");
  };
  for (const auto& name : only) {
    if (std::ranges::none_of(runs, [&](const SuiteRun& run) { return selects(name, run); }))
      throw InputError(
          fmt::format("--only {}: selects no run; 'talus-validate list SUITE' tells their names", name));
  }
  std::vector<SuiteRun> wanted;
  for (const auto& run : runs) {
    if (std::ranges::any_of(only, [&](const std::string& name) { return selects(name, run); }))
      wanted.push_back(run);
  }
  return wanted;
}

std::string input_hash_of(const SuiteRun& run) {
  const ScratchFolder folder;
  return dem::prepare_run(run.run, folder.path() / "input");
}

std::optional<FoundRecord> find_record(const SuiteRun& run) { return find_record(run, input_hash_of(run)); }

std::string state_of(const SuiteRun& run) {
  if (find_record(run)) return "stored";
  return own_record(run) ? "stale" : "missing";
}

int make_runs(const std::vector<SuiteRun>& runs, const MakingOptions& options) {
  std::vector<dem::QueuedJob> queue;
  double cost = 0.0;
  for (const SuiteRun& run : runs) {
    if (options.stop()) break;
    const std::string input_hash = input_hash_of(run);
    if (!options.force && find_record(run, input_hash)) continue;
    cost += run.run.expected_cpu;
    queue.push_back({.label = dem::label(run.run),
                     .expected_cpu = run.run.expected_cpu,
                     .run = [&run, input_hash, &options] { make(run, input_hash, options.stop); },
                     .progress = [&run] { return run.run.progress(partial(run)); }});
  }
  spdlog::info("{} of {} runs to make, about {:.0f} CPU-s, {} at a time", queue.size(), runs.size(), cost,
               options.workers);
  const int failures = dem::run_side_by_side(queue, options.workers, options.stop);
  if (options.stop()) throw RunError("interrupted; finished runs are kept, the same command makes the rest");
  if (failures > 0)
    throw RunError(
        fmt::format("{} of {} runs failed, as told above; the others are kept", failures, queue.size()));
  return static_cast<int>(queue.size());
}

}  // namespace talus::validation
