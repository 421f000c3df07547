#include "dem_cases/yade/yade.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "continuum/files/data_folder.h"
#include "continuum/files/process.h"
#include "dem_cases/container.h"
#include "dem_cases/falling_sphere.h"
#include "dem_cases/grain_dump.h"
#include "dem_cases/time_step.h"
#include "dem_cases/yade/rolling.h"

namespace talus::dem::yade {
namespace {

constexpr std::string_view script_file = "gravity_flow.py";
constexpr std::string_view ball_file = "falling_ball.py";
constexpr std::string_view parameters_file = "parameters.json";
constexpr std::string_view packing_file = "packing.txt";

/// Half way down the fill, where a grain carries the weight above it.
double middle_pressure(const Case& a_case) {
  return a_case.protocol.volume_fraction * a_case.grains.density * a_case.protocol.gravity * 0.5 *
         fill_height(a_case.geometry);
}

nlohmann::json point(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

const char* material_of(Surface surface) { return surface == Surface::floor ? "grain" : "wall"; }

nlohmann::json planes(const Container& container) {
  auto list = nlohmann::json::array();
  for (const Plane& plane : container.planes) {
    list.push_back({{"name", plane.name},
                    {"axis", plane.axis},
                    {"at_m", plane.at},
                    {"inward", plane.inward},
                    {"material", material_of(plane.surface)},
                    {"until_release", plane.until_release}});
  }
  return list;
}

nlohmann::json shells(const Container& container) {
  auto list = nlohmann::json::array();
  for (const Shell& shell : container.shells) {
    auto triangles = nlohmann::json::array();
    for (const Triangle& triangle : triangles_of(shell))
      triangles.push_back({point(triangle[0]), point(triangle[1]), point(triangle[2])});
    list.push_back({{"name", shell.name},
                    {"triangles_m", triangles},
                    {"material", "wall"},
                    {"until_release", shell.until_release},
                    {"rise_speed_m_s", shell.rise_speed}});
  }
  return list;
}

nlohmann::json parameters(const Case& column, const Packing& packing) {
  const StepSchedule schedule = step_schedule(column);
  const Container container = container_of(column);
  Eigen::Vector3d upper = container.upper;
  upper.z() = std::max(upper.z(), packing.top() + 4.0 * column.grains.diameter);
  nlohmann::json all{
      {"case", column.name},
      {"point", column.point},
      {"seed", packing.seed},
      {"fixed_count", packing.fixed_count},
      {"periodic", container.periodic},
      {"lower_m", point(container.lower)},
      {"upper_m", point(upper)},
      {"planes", planes(container)},
      {"shells", shells(container)},
      {"diameter_m", column.grains.diameter},
      {"density_kg_m3", column.grains.density},
      {"youngs_modulus_pa", column.grains.youngs_modulus},
      {"poissons_ratio", column.grains.poissons_ratio},
      {"restitution", column.contact.restitution},
      {"friction", column.contact.friction},
      {"wall_friction", column.contact.wall_friction},
      {"rolling_resistance", rolling_resistance(column.contact.rolling_friction)},
      {"rolling_stiffness_n_m",
       rolling_stiffness(column.grains, column.contact.rolling_friction, middle_pressure(column))},
      {"gravity_m_s2", column.protocol.gravity},
      {"time_step_s", column.protocol.time_step},
      {"settle_steps", schedule.settle},
      {"steps_per_snapshot", schedule.per_snapshot},
      {"snapshot_count", schedule.snapshot_count},
  };
  if (const auto sphere = falling_sphere(column)) {
    all["sphere"] = {{"radius_m", sphere->radius},
                     {"density_kg_m3", sphere->density},
                     {"centre_m", point(sphere->centre)},
                     {"speed_m_s", sphere->speed}};
  }
  return all;
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

/// An impact's is the others' with the sphere added between the release and the run.
std::string script_text(const Case& a_case) {
  const std::filesystem::path scripts = data_folder("dem_cases/yade");
  std::string text = read_file(scripts / script_file);
  if (!falling_sphere(a_case)) return text;
  const auto place = text.find("with open('grains.dump', 'w')");
  if (place == std::string::npos)
    throw InputError(fmt::format("{}: has no line that opens grains.dump", (scripts / script_file).string()));
  return text.insert(place, read_file(scripts / ball_file));
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
  for (const auto stale :
       {std::string_view(analysis::body_track_file), dump_file, contacts_file, progress_file, log_file})
    std::filesystem::remove(folder / stale);
  write_file_atomically(folder / packing_file, packing_text(packing));
  write_file_atomically(folder / parameters_file, parameters(column, packing).dump(2) + "\n");
  write_file_atomically(folder / script_file, script_text(column));
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
