#include "dem_cases/yade/yade.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "dem_cases/grain_dump.h"
#include "dem_cases/process.h"
#include "dem_cases/time_step.h"

namespace talus::dem::yade {
namespace {

constexpr std::string_view script_file = "column_collapse.py";
constexpr std::string_view parameters_file = "parameters.json";
constexpr std::string_view packing_file = "packing.txt";

/// LIGGGHTS' epsd2 gives each contact the rolling stiffness k_t R*^2, k_t = 8 G* sqrt(R* overlap) (Iwashita &
/// Oda 1998); YADE takes one number for all contacts, so it gets that of a contact half way down the column,
/// where a grain carries the weight above it. The limit of the moment, not this stiffness, decides how grains
/// roll.
double rolling_stiffness(const Case& column) {
  if (column.contact.rolling_friction == 0.0) return 0.0;
  const Grains& grains = column.grains;
  const double radius = 0.25 * grains.diameter;  // R*, of two equal grains
  const double modulus =
      grains.youngs_modulus / (2.0 * (1.0 - grains.poissons_ratio * grains.poissons_ratio));
  const double shear_modulus =
      grains.youngs_modulus / (4.0 * (1.0 + grains.poissons_ratio) * (2.0 - grains.poissons_ratio));
  const double pressure = column.protocol.volume_fraction * grains.density * column.protocol.gravity * 0.5 *
                          column.geometry.column_height;
  const double force = pressure * grains.diameter * grains.diameter;
  const double overlap = std::pow(0.75 * force / (modulus * std::sqrt(radius)), 2.0 / 3.0);
  return 8.0 * shear_modulus * std::sqrt(radius * overlap) * radius * radius;
}

nlohmann::json parameters(const Case& column, const Packing& packing) {
  const StepSchedule schedule = step_schedule(column);
  return {
      {"case", column.name},
      {"input_hash", column.input_hash},
      {"seed", packing.seed},
      {"fixed_count", packing.fixed_count},
      {"column_length_m", column.geometry.column_length},
      {"thickness_m", column.geometry.thickness},
      {"tank_length_m", column.geometry.tank_length},
      {"top_m", packing.top()},
      {"rough_floor", column.geometry.rough_floor},
      {"diameter_m", column.grains.diameter},
      {"density_kg_m3", column.grains.density},
      {"youngs_modulus_pa", column.grains.youngs_modulus},
      {"poissons_ratio", column.grains.poissons_ratio},
      {"restitution", column.contact.restitution},
      {"friction", column.contact.friction},
      {"wall_friction", column.contact.wall_friction},
      // The moment is limited by eta (R1 + R2) / 2 F_n here and by mu_r R1 R2 / (R1 + R2) F_n in the case:
      // for equal grains eta = mu_r / 2. Against a box YADE takes the grain's radius for both. It has one eta
      // for all contacts.
      {"rolling_resistance", 0.5 * column.contact.rolling_friction},
      {"rolling_stiffness_n_m", rolling_stiffness(column)},
      {"gravity_m_s2", column.protocol.gravity},
      {"time_step_s", column.protocol.time_step},
      {"settle_steps", schedule.settle},
      {"steps_per_snapshot", schedule.per_snapshot},
      {"snapshot_count", schedule.snapshot_count},
  };
}

std::string packing_text(const Packing& packing) {
  std::string text = "# x y z vx vy vz radius, SI units; the fixed grains first\n";
  for (Eigen::Index i = 0; i < packing.count(); ++i) {
    for (const double value : packing.positions.col(i)) text += fmt::format("{:.17g} ", value);
    for (const double value : packing.velocities.col(i)) text += fmt::format("{:.17g} ", value);
    text += fmt::format("{:.17g}\n", packing.radii[i]);
  }
  return text;
}

}  // namespace

std::string version() {
  const auto program = find_program("yade", "yade");
  const std::string said = output_of({program.string(), "--version"});
  constexpr std::string_view before = "Yade version: ";
  const auto at = said.find(before);
  if (at == std::string::npos)
    throw InputError(fmt::format("{}: does not tell its version; it said: {}", program.string(), said));
  const auto begin = at + before.size();
  return said.substr(begin, said.find_first_of(", \n", begin) - begin);
}

void write_input(const Case& column, const Packing& packing, const std::filesystem::path& folder) {
  check_time_step(column);
  make_writable_folder(folder);
  for (const auto stale : {dump_file, progress_file, log_file}) std::filesystem::remove(folder / stale);
  write_file_atomically(folder / packing_file, packing_text(packing));
  write_file_atomically(folder / parameters_file, parameters(column, packing).dump(2) + "\n");
  write_file_atomically(folder / script_file,
                        read_file(std::filesystem::path(TALUS_YADE_SCRIPT_FOLDER) / script_file));
}

std::vector<std::string> command() {
  return {"/usr/bin/env", "OMP_NUM_THREADS=1",     find_program("yade", "yade").string(), "-n", "-x",
          "-j1",          std::string(script_file)};
}

double progress(const Case& column, const std::filesystem::path& folder) {
  return progress_of_run(column, folder);
}

/// A Python exception ends in a line like "ValueError: ..."; YADE's own fatal messages contain "FATAL".
std::string failure_text(const std::filesystem::path& folder) {
  std::ifstream in(folder / log_file);
  std::string found;
  for (std::string line; std::getline(in, line);) {
    const auto name_end = line.find(": ");
    const std::string_view name =
        std::string_view(line).substr(0, name_end == std::string::npos ? 0 : name_end);
    if (name.ends_with("Error") || name.ends_with("Exception") || line.find("FATAL") != std::string::npos)
      found = line;
  }
  return found;
}

analysis::SnapshotSeries read_output(const Case& column, const Packing& packing,
                                     const std::filesystem::path& folder) {
  return read_grain_dump(column, packing, folder);
}

}  // namespace talus::dem::yade
