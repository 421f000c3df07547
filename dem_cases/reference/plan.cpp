#include "dem_cases/reference/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "analysis/snapshot.h"
#include "continuum/files/checked_table.h"
#include "continuum/files/data_folder.h"
#include "continuum/files/provenance.h"
#include "dem_cases/falling_sphere.h"
#include "dem_cases/grain_dump.h"
#include "dem_cases/liggghts/liggghts.h"
#include "dem_cases/measure.h"
#include "dem_cases/packing/packing.h"
#include "dem_cases/shear_cell/shear_cell.h"
#include "dem_cases/time_step.h"
#include "dem_cases/yade/yade.h"

namespace talus::dem {
namespace {

/// One discrete code, as a run needs it.
struct Code {
  std::string name;
  double grain_steps_per_second;  // of one core, roughly (dem.md)
  std::string version;
  std::vector<std::string> command;
  std::string log_file;
  decltype(&liggghts::write_input) write_input;
  decltype(&liggghts::failure_text) failure_text;
};

/// The programs are asked for their versions once: YADE takes seconds to start.
const Code& code_named(const std::string& name) {
  if (name == "liggghts") {
    static const Code code{name,
                           2.5e6,
                           liggghts::version(),
                           liggghts::command(),
                           std::string(liggghts::log_file),
                           &liggghts::write_input,
                           &liggghts::failure_text};
    return code;
  }
  static const Code code{name,
                         3.5e5,
                         yade::version(),
                         yade::command(),
                         std::string(yade::log_file),
                         &yade::write_input,
                         &yade::failure_text};
  return code;
}

/// Raise it when measure() comes to other figures of the same series.
constexpr int ruler_version = 1;

void check_at_rest(const Case& a_case, const nlohmann::json& measured) {
  const auto& observables = measured.at("observables");
  if (observables.contains("at_rest") && !observables.at("at_rest").get<bool>()) {
    const std::string figures =
        observables.contains("still_leaving")
            ? fmt::format(" (left in the last tenth of the time: {:.2g}; kinetic energy / (m g d): {:.2g})",
                          observables.at("still_leaving").get<double>(),
                          observables.at("rest_energy").get<double>())
            : std::string();
    throw InputError(
        fmt::format("the deposit had not come to rest at the end{}; lengthen protocol.run_time_s in {}",
                    figures, a_case.file.string()));
  }
}

/// Keeps the snapshots for a look with ParaView.
void keep_snapshots(const analysis::SnapshotSeries& series, const PlannedRun& run,
                    const std::filesystem::path& folder) {
  nlohmann::json made_by = provenance();
  made_by["run"] = label(run);
  made_by["code_version"] = run.version;
  analysis::write_snapshots(folder / "snapshots.h5", series, made_by.dump());
}

}  // namespace

nlohmann::json measurement_of(const Case& a_case) {
  const Ruler& ruler = a_case.ruler;
  return {{"ruler_version", ruler_version},     {"profile_bin_m", ruler.profile_bin},
          {"front_depth_m", ruler.front_depth}, {"window_upper", ruler.window_upper},
          {"window_lower", ruler.window_lower}, {"rest_energy", a_case.protocol.rest_energy}};
}

PlannedRun planned_run(const Case& a_case, const std::string& code_name, std::uint64_t seed) {
  constexpr double patience = 20.0;  // times the expected cost; a run that hangs must end
  const StepSchedule schedule = step_schedule(a_case);
  const auto steps = static_cast<double>(schedule.settle + schedule.run());
  const Code& code = code_named(code_name);
  PlannedRun run;
  run.case_name = a_case.name;
  run.point_name = a_case.point;
  run.code = code_name;
  run.seed = seed;
  run.version = code.version;
  run.command = code.command;
  run.log_file = code.log_file;
  run.expected_cpu = expected_grains(a_case) * steps / code.grain_steps_per_second;
  run.time_limit = 600.0 + patience * run.expected_cpu;
  run.measurement = measurement_of(a_case);
  run.write_input = [a_case, seed, write = code.write_input](const auto& folder) {
    write(a_case, make_packing(a_case, seed), folder);
  };
  run.progress = [a_case](const auto& folder) { return progress_of_run(a_case, folder); };
  run.failure_text = code.failure_text;
  run.measure = [a_case, named = run](const auto& folder) {
    const auto series = read_grain_dump(a_case, make_packing(a_case, named.seed), folder);
    nlohmann::json measured =
        measure(a_case, series, periodic_thickness(a_case.geometry), read_track(a_case, folder));
    measured["grains"] = series.front().volumes.size();
    keep_snapshots(series, named, folder);
    return measured;
  };
  return run;
}

std::vector<PlannedRun> planned_runs(const Case& a_case) {
  std::vector<PlannedRun> runs;
  for (const auto& [name, seeds] : a_case.reference_seeds) {
    for (const std::uint64_t seed : seeds) {
      PlannedRun run = planned_run(a_case, name, seed);
      run.measure = [a_case, measure_any = run.measure](const auto& folder) {
        nlohmann::json measured = measure_any(folder);
        check_at_rest(a_case, measured);
        return measured;
      };
      runs.push_back(std::move(run));
    }
  }
  return runs;
}

std::vector<std::filesystem::path> gravity_case_files() {
  const std::filesystem::path cases = data_folder("dem_cases");
  return {cases / "column_collapse/case.toml", cases / "column_collapse/cylinder.toml",
          cases / "hourglass/case.toml",       cases / "hourglass/cone.toml",
          cases / "pile_angle/case.toml",      cases / "pile_angle/heap.toml",
          cases / "impact/case.toml"};
}

std::filesystem::path slot_case_file() { return data_folder("dem_cases") / "hourglass/case.toml"; }

std::filesystem::path shear_cell_file() { return data_folder("dem_cases") / "shear_cell/case.toml"; }

std::vector<PlannedRun> planned_runs_of_file(const std::filesystem::path& file) {
  if (CheckedTable::parse_file(file).string("kind") == "shear_cell")
    return shear_cell_runs(read_shear_cell(file));
  std::vector<PlannedRun> runs;
  for (const Case& point : read_case_points(file))
    std::ranges::move(planned_runs(point), std::back_inserter(runs));
  return runs;
}

std::vector<PlannedRun> all_planned_runs() {
  std::vector<PlannedRun> runs;
  for (const auto& file : gravity_case_files())
    std::ranges::move(planned_runs_of_file(file), std::back_inserter(runs));
  std::ranges::move(planned_runs_of_file(shear_cell_file()), std::back_inserter(runs));
  return runs;
}

}  // namespace talus::dem
