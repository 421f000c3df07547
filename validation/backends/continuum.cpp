// Case -> scene for `talus run`.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "dem_cases/process.h"
#include "validation/backends/backend.h"

namespace talus::validation {
namespace {

constexpr const char* scene_name = "scene.toml";
constexpr const char* log_name = "talus.out";

/// The program that was built beside this one.
std::filesystem::path talus_program() {
  const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "talus";
  if (std::filesystem::exists(program)) return program;
  const auto beside = std::filesystem::path(program).parent_path().parent_path() / "bin" / "talus";
  if (std::filesystem::exists(beside)) return beside;
  throw InputError(
      fmt::format("{}: the continuum solver is not there; build the target 'talus'", program.string()));
}

double degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

/// Plane strain: y is periodic and one cell thick. The floor is as rough as the sand; walls take the case's
/// friction. The domain is the tank, two column heights high, in whole cells.
std::string scene_text(const RunRequest& request) {
  const dem::ColumnGeometry& geometry = column_geometry(request.column);
  const dem::Protocol& protocol = request.column.protocol;
  const double h = geometry.column_length / request.resolution.cells_per_column_length;
  const double length = h * std::ceil(geometry.tank_length / h - 1e-9);
  const double height = h * std::ceil(2.0 * geometry.column_height / h - 1e-9);
  const double friction_deg = degrees(request.material.friction_angle);
  const double wall_deg = degrees(std::atan(request.column.contact.wall_friction));
  return fmt::format(R"(# Written from {case_file}, seed {seed}, by talus-validate.
schema = 1

[domain]
origin_m = [0.0, 0.0, 0.0]
size_m = [{length:.17g}, {h:.17g}, {height:.17g}]
cell_size_m = {h:.17g}
gravity_m_s2 = [0.0, 0.0, {gravity:.17g}]
periodic = ["y"]
x_lower = {{ kind = "wall", friction_angle_deg = {wall:.17g} }}
x_upper = {{ kind = "wall", friction_angle_deg = {wall:.17g} }}
z_lower = {{ kind = "wall", friction_angle_deg = {friction:.17g} }}

[[material]]
name = "sand"
grain_density_kg_m3 = {density:.17g}
max_volume_fraction = {volume_fraction:.17g}
friction_angle_deg = {friction:.17g}

[[sand]]
material = "sand"
shape = {{ kind = "box", lower_m = [0.0, 0.0, 0.0], upper_m = [{column_length:.17g}, {h:.17g}, {column_height:.17g}] }}

[particles]
per_cell_axis = {per_axis}
jitter = {jitter:.17g}
seed = {seed}

[time]
end_s = {end:.17g}
frame_interval_s = {interval:.17g}
)",
                     fmt::arg("case_file", request.column.file.filename().string()),
                     fmt::arg("seed", request.seed), fmt::arg("length", length), fmt::arg("height", height),
                     fmt::arg("h", h), fmt::arg("gravity", -protocol.gravity), fmt::arg("wall", wall_deg),
                     fmt::arg("friction", friction_deg), fmt::arg("density", request.column.grains.density),
                     fmt::arg("volume_fraction", request.material.max_volume_fraction),
                     fmt::arg("column_length", geometry.column_length),
                     fmt::arg("column_height", geometry.column_height),
                     fmt::arg("per_axis", request.resolution.particles_per_cell_axis),
                     fmt::arg("jitter", request.resolution.lattice_jitter),
                     fmt::arg("end", protocol.run_time), fmt::arg("interval", protocol.snapshot_interval));
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

}  // namespace

Backend make_continuum_backend(const RunRequest& request) {
  if (!column_geometry(request.column).rough_floor) {
    throw InputError(
        fmt::format("{}: key 'geometry.floor': the continuum knows the wall friction of a rough floor only; "
                    "a flat floor's is not in the calibration yet",
                    request.column.file.string()));
  }
  Backend backend;
  backend.version = dem::output_of({talus_program().string(), "--version"});
  backend.version.erase(backend.version.find_last_not_of('\n') + 1);
  // The harness runs a job to a core.
  backend.command = {talus_program().string(), "run", scene_name, "--output", ".", "--threads", "1"};
  backend.log_file = log_name;
  backend.thickness =
      column_geometry(request.column).column_length / request.resolution.cells_per_column_length;
  backend.write_input = [text = scene_text(request)](const auto& folder) {
    write_file_atomically(folder / scene_name, text);
  };
  backend.progress = frames_done;
  backend.failure_text = [](const auto& folder) { return last_line(folder / log_name); };
  backend.read_output = [](const auto& folder) { return analysis::read_snapshots(folder / "snapshots.h5"); };
  backend.solver_summary = [](const auto& folder) {
    return nlohmann::json::parse(read_file(folder / "run.json"))["budget"];
  };
  return backend;
}

}  // namespace talus::validation
