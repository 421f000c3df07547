#include "validation/backends/continuum.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "analysis/snapshot.h"
#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"
#include "continuum/files/process.h"
#include "continuum/files/provenance.h"
#include "dem_cases/falling_sphere.h"
#include "dem_cases/measure.h"
#include "dem_cases/reference/plan.h"
#include "validation/backends/balances.h"

namespace talus::validation {
namespace {

constexpr const char* scene_name = "scene.toml";
constexpr const char* log_name = "talus.out";

/// The program that was built beside this one.
std::filesystem::path talus_program() {
  auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "talus";
  if (std::filesystem::exists(program)) return program;
  auto beside = program.parent_path().parent_path() / "bin" / "talus";
  if (std::filesystem::exists(beside)) return beside;
  throw InputError(
      fmt::format("{}: the continuum solver is not there; build the target 'talus'", program.string()));
}

/// From the last "frame i/n" that the solver has told.
double frames_done(const std::filesystem::path& folder) {
  std::ifstream log(folder / log_name);
  double fraction = 0.0;
  for (std::string line; std::getline(log, line);) {
    int frame = 0, frames = 0;
    const auto at = line.find("frame ");
    if (at != std::string::npos && std::sscanf(line.c_str() + at, "frame %d/%d", &frame, &frames) == 2 &&
        frames > 0) {
      fraction = static_cast<double>(frame) / frames;
    }
  }
  return fraction;
}

std::string last_line(const std::filesystem::path& file) {
  std::ifstream log(file);
  std::string last;
  for (std::string line; std::getline(log, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

/// What left the domain is not in the deposit.
void check_nothing_lost(const analysis::SnapshotSeries& series) {
  const double released = series.front().volumes.sum();
  for (const auto& snapshot : series) {
    const double lost = 1.0 - snapshot.volumes.sum() / released;
    if (std::abs(lost) > 1e-9) {
      throw InputError(fmt::format("{:.3g} of the volume was gone at t = {:.4g} s: something left the domain",
                                   lost, snapshot.time));
    }
  }
}

/// Of the square floor that a deposit spreads on, m; 0 for other cases.
double floor_side(const dem::Case& a_case) {
  if (const auto* cylinder = std::get_if<dem::CylinderGeometry>(&a_case.geometry))
    return cylinder->floor_side;
  if (const auto* heap = std::get_if<dem::HeapGeometry>(&a_case.geometry)) return heap->floor_side;
  return 0.0;
}

/// The far wall must not shape a deposit, nor its floor end under it.
void check_clear_of_edges(const dem::Case& a_case, const analysis::SnapshotSeries& series) {
  const auto error = [&](double time, const char* key) {
    return InputError(fmt::format("at t = {:.4g} s something reached the edge: raise geometry.{} in {}", time,
                                  key, a_case.file.string()));
  };
  for (const auto& snapshot : series) {
    if (const auto* column = std::get_if<dem::ColumnGeometry>(&a_case.geometry)) {
      if (snapshot.positions.row(0).maxCoeff() > column->tank_length - a_case.grains.diameter)
        throw error(snapshot.time, "tank_length_m");
    }
    if (const auto side = floor_side(a_case); side > 0.0) {
      if (snapshot.positions.topRows(2).cwiseAbs().maxCoeff() > 0.5 * side - a_case.grains.diameter)
        throw error(snapshot.time, "floor_side_m");
    }
  }
}

nlohmann::json measure_run(const ContinuumRequest& request, const std::filesystem::path& folder) {
  const auto series = analysis::read_snapshots(folder / "snapshots.h5");
  check_nothing_lost(series);
  check_clear_of_edges(request.a_case, series);
  const double thickness = cell_size(request.a_case, request.resolution.cells);
  nlohmann::json measured =
      dem::measure(request.a_case, series, thickness, dem::read_track(request.a_case, folder));
  const double densest_bulk = request.a_case.grains.density * request.material.max_volume_fraction;
  const Balances balances =
      read_balances(folder / "budget.csv", densest_bulk, request.a_case.protocol.gravity);
  auto& observables = measured["observables"];
  observables["bulk_density"] = balances.bulk_density;
  if (observables.contains("at_rest")) observables["support"] = balances.support;
  measured["solver"] = nlohmann::json::parse(read_file(folder / "run.json")).at("budget");
  measured["count"] = series.back().volumes.size();
  measured["time_step_s"] = measured["solver"].at("longest_step_s");
  measured["thickness_m"] = thickness;
  return measured;
}

}  // namespace

const std::string& continuum_version() {
  static const std::string version = [] {
    std::string text = output_of({talus_program().string(), "--solver"});
    text.erase(text.find_last_not_of('\n') + 1);
    return text;
  }();
  return version;
}

dem::PlannedRun continuum_run(const ContinuumRequest& request) {
  dem::PlannedRun run;
  run.case_name = request.a_case.name;
  run.point_name = request.a_case.point;
  run.code = request.code;
  run.seed = request.seed;
  run.version = continuum_version();
  // The harness runs a job to a core.
  run.program = talus_program();
  run.command = {"talus", "run", scene_name, "--output", ".", "--threads", "1"};
  run.log_file = log_name;
  run.expected_cpu = expected_continuum_cpu(request.a_case, request.resolution);
  run.time_limit = request.time_limit;
  run.measurement = dem::measurement_of(request.a_case);
  // What the measuring knows of the case beside the ruler; a scene in plane strain has another thickness, and no grains.
  run.measurement["case_thickness_m"] = dem::periodic_thickness(request.a_case.geometry);
  run.measurement["grain_diameter_m"] = request.a_case.grains.diameter;
  run.write_input = [text = continuum_scene(request.a_case, request.material, request.resolution,
                                            request.seed, request.defects)](const auto& folder) {
    write_file_atomically(folder / scene_name, text);
  };
  run.progress = frames_done;
  run.failure_text = [](const auto& folder) { return last_line(folder / log_name); };
  run.measure = [request](const auto& folder) { return measure_run(request, folder); };
  return run;
}

}  // namespace talus::validation
