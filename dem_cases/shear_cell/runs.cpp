// Every run of the shear cell, as the reference generator takes it.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "continuum/files/atomic_file.h"
#include "continuum/files/data_folder.h"
#include "continuum/files/process.h"
#include "dem_cases/liggghts/liggghts.h"
#include "dem_cases/shear_cell/liggghts_deck.h"
#include "dem_cases/shear_cell/measure.h"
#include "dem_cases/shear_cell/schedule.h"
#include "dem_cases/shear_cell/shear_cell.h"
#include "dem_cases/shear_cell/start.h"
#include "dem_cases/shear_cell/yade_input.h"
#include "dem_cases/yade/yade.h"

namespace talus::dem {
namespace {

using std::filesystem::path;

constexpr std::string_view yade_script = "shear_cell.py";

/// Ten times what was measured on an idle core; beyond it something hangs.
constexpr double liggghts_seconds_per_grain_step = 1e-5, yade_seconds_per_grain_step = 5e-5;
constexpr double start_up = 60.0;  // s

/// So that output of an earlier run cannot pass for this one's.
void empty_folder(const path& folder, std::string_view log) {
  make_writable_folder(folder);
  for (const auto stale : {samples_file, log, std::string_view("log.liggghts")})
    std::filesystem::remove(folder / stale);
}

PlannedRun liggghts_run(const ShearCell& cell, std::string point, std::uint64_t seed, double grains,
                        double steps, const std::string& version) {
  const auto compression = static_cast<double>(steps_for(cell.protocol, cell.protocol.compression_time));
  return {.case_name = cell.name,
          .point_name = std::move(point),
          .code = "liggghts",
          .seed = seed,
          .version = version,
          .command = liggghts::command(),
          .log_file = std::string(liggghts::log_file),
          .expected_cpu = 0.1 * liggghts_seconds_per_grain_step * grains * (compression + steps),
          .time_limit = start_up + liggghts_seconds_per_grain_step * grains * (compression + steps),
          .measurement = {},
          .write_input = {},
          .progress = {},
          .failure_text = [](const path& folder) { return liggghts::failure_text(folder); },
          .measure = {}};
}

void write_liggghts_input(const path& folder, const std::string& packing, const std::string& deck) {
  empty_folder(folder, liggghts::log_file);
  write_file_atomically(folder / "packing.data", packing);
  write_file_atomically(folder / "in.liggghts", deck);
}

/// Raise the version when measure.h comes to other figures of the same samples.
nlohmann::json measurement_of(const ShearCell& cell, double averaged_from, double strain) {
  return {{"ruler_version", 1},
          {"stress_tolerance", cell.protocol.stress_tolerance},
          {"inertial_tolerance", cell.protocol.inertial_tolerance},
          {"least_strain", cell.protocol.least_strain},
          {"averaged_from", averaged_from},
          {"strain", strain}};
}

PlannedRun plan_simple_shear(const ShearCell& cell, const ShearMaterial& material,
                             const SimpleShearPoint& point, std::uint64_t seed, const std::string& version) {
  const auto count = make_walled_start(cell, seed).count();
  const auto steps = static_cast<double>(step_count(cell, point));
  PlannedRun run =
      liggghts_run(cell, point_name(material, point), seed, static_cast<double>(count), steps, version);
  run.write_input = [=](const path& folder) {
    const ShearStart start = make_walled_start(cell, seed);
    write_liggghts_input(folder, liggghts_packing(cell, start),
                         simple_shear_deck(cell, material, point, start));
  };
  run.progress = [=](const path& folder) { return samples_progress(folder, steps); };
  run.measurement = measurement_of(cell, point.transient_strain, point.strain);
  run.measure = [=](const path& folder) { return measure_simple_shear(cell, point, count, folder); };
  return run;
}

PlannedRun plan_biaxial(const ShearCell& cell, const ShearMaterial& material, const BiaxialPoint& point,
                        std::uint64_t seed, const std::string& version) {
  const auto count = make_periodic_start(cell, seed).count();
  const auto steps = static_cast<double>(step_count(cell, point));
  PlannedRun run =
      liggghts_run(cell, point_name(material, point), seed, static_cast<double>(count), steps, version);
  run.write_input = [=](const path& folder) {
    const ShearStart start = make_periodic_start(cell, seed);
    write_liggghts_input(folder, liggghts_packing(cell, start), biaxial_deck(cell, material, point, start));
  };
  run.progress = [=](const path& folder) { return samples_progress(folder, steps); };
  run.measurement = measurement_of(cell, point.averaged_from, point.axial_strain);
  run.measure = [=](const path& folder) { return measure_biaxial(cell, point, count, folder); };
  return run;
}

/// The same start, protocol and samples; only the code is another.
PlannedRun plan_yade_biaxial(const ShearCell& cell, const ShearMaterial& material, const BiaxialPoint& point,
                             std::uint64_t seed, const std::string& version) {
  PlannedRun run = plan_biaxial(cell, material, point, seed, version);
  run.code = "yade";
  run.command = {"/usr/bin/env", "OMP_NUM_THREADS=1",     find_program("yade", "yade").string(), "-n", "-x",
                 "-j1",          std::string(yade_script)};
  run.log_file = std::string(yade::log_file);
  run.expected_cpu *= yade_seconds_per_grain_step / liggghts_seconds_per_grain_step;
  run.time_limit *= yade_seconds_per_grain_step / liggghts_seconds_per_grain_step;
  run.failure_text = [](const path& folder) { return yade::failure_text(folder); };
  run.write_input = [=](const path& folder) {
    const ShearStart start = make_periodic_start(cell, seed);
    empty_folder(folder, yade::log_file);
    write_file_atomically(folder / "packing.txt", yade_packing(start));
    write_file_atomically(folder / "parameters.json",
                          yade_biaxial_parameters(cell, material, point, start).dump(2) + "\n");
    write_file_atomically(folder / yade_script, read_file(data_folder("dem_cases/shear_cell") / yade_script));
  };
  return run;
}

}  // namespace

std::string point_name(const ShearMaterial& material, const SimpleShearPoint& point) {
  return fmt::format("simple_shear-{}-{}", material.name, point.inertial_number);
}

std::string point_name(const ShearMaterial& material, const BiaxialPoint& point) {
  return fmt::format("biaxial-{}-{}", material.name, point.inertial_number);
}

std::vector<PlannedRun> shear_cell_runs(const ShearCell& cell) {
  const std::string liggghts_version = liggghts::version(), yade_version = yade::version();
  std::vector<PlannedRun> runs;
  for (const ShearMaterial& material : cell.materials) {
    for (const SimpleShearPoint& point : cell.simple_shear.points) {
      for (const auto seed : cell.simple_shear.liggghts_seeds)
        runs.push_back(plan_simple_shear(cell, material, point, seed, liggghts_version));
    }
    for (const BiaxialPoint& point : cell.biaxial.points) {
      for (const auto seed : cell.biaxial.liggghts_seeds)
        runs.push_back(plan_biaxial(cell, material, point, seed, liggghts_version));
    }
    for (const auto seed : cell.biaxial.yade_seeds)
      runs.push_back(plan_yade_biaxial(cell, material, cell.biaxial.points.front(), seed, yade_version));
  }
  return runs;
}

}  // namespace talus::dem
