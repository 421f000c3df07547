#include "continuum/scene/scene.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "continuum/files/faults.h"
#include "continuum/files/provenance.h"
#include "continuum/scene/cost.h"
#include "continuum/scene/read_bodies.h"
#include "continuum/scene/read_common.h"
#include "continuum/scene/read_domain.h"
#include "continuum/scene/read_explosions.h"
#include "continuum/scene/read_sand.h"
#include "continuum/scene/read_solver.h"

namespace talus {
namespace {

constexpr double most_frames = 1e6;

/// per_cell_axis = n, or per_cell = [nx, ny, nz]: one along an axis is enough where nothing varies along it.
Eigen::Vector3i read_particles_per_cell(const CheckedTable& particles) {
  constexpr int most = 8;
  if (!particles.has("per_cell"))
    return Eigen::Vector3i::Constant(static_cast<int>(particles.integer("per_cell_axis", 2, most)));
  if (particles.has("per_cell_axis"))
    throw particles.error("per_cell", "stands for per_cell_axis; give one of the two");
  return particles.integer_vector("per_cell", 1, most);
}

void read_particles(const CheckedTable& root, Scene& scene) {
  constexpr std::array<std::string_view, 2> transfers{"flip", "apic"};
  const CheckedTable particles = root.table("particles");
  scene.particles_per_cell = read_particles_per_cell(particles);
  scene.jitter = particles.number("jitter", {0.0, 1.0});
  scene.seed =
      static_cast<std::uint64_t>(particles.integer("seed", 0, std::numeric_limits<std::int64_t>::max()));
  if (particles.has("transfer") && particles.choice("transfer", transfers) == "apic")
    scene.settings.transfer = Transfer::apic;
  scene.settings.reshape = particles.boolean("split_and_merge", scene.settings.reshape);
  particles.finish();
}

int read_render_points(const CheckedTable& root) {
  constexpr int most_per_particle = 1000;
  const auto table = root.optional_table("render_points");
  if (!table) return 0;
  const auto per_particle = static_cast<int>(table->integer("per_particle", 0, most_per_particle));
  table->finish();
  return per_particle;
}

void read_time(const CheckedTable& root, Scene& scene) {
  const CheckedTable time = root.table("time");
  scene.end_time = time.number("end_s", time_range);
  scene.frame_interval = time.number("frame_interval_s", time_range);
  if (scene.end_time / scene.frame_interval > most_frames) {
    throw time.error("frame_interval_s", fmt::format("gives more than {:.0g} frames until end_s = {}",
                                                     most_frames, scene.end_time));
  }
  time.finish();
}

void read_table_5_1(const CheckedTable& root, Scene& scene) {
  const auto table = root.optional_table("table_5_1");
  if (!table) return;
  scene.table_5_1 =
      SourceFigures{table->number("particles", positive), table->number("render_points", positive),
                    table->number("seconds_per_frame", positive)};
  table->finish();
}

/// Before anything of the scene's size is made.
void check_size(const CheckedTable& root, const SceneLimits& limits, const Scene& scene) {
  const SceneCost cost = scene_cost(scene);
  const CheckedTable particles = root.table("particles");
  const std::string_view per_cell = particles.has("per_cell") ? "per_cell" : "per_cell_axis";
  if (cost.lattice_points > limits.particles) {
    throw particles.error(per_cell, fmt::format("gives {:.3g} particles; at most {:.0g}", cost.lattice_points,
                                                limits.particles));
  }
  if (cost.render_points > limits.render_points) {
    throw root.table("render_points")
        .error("per_particle",
               fmt::format("gives {:.3g} points; at most {:.0g}", cost.render_points, limits.render_points));
  }
  if (cost.bytes > limits.memory) {
    throw root.table("domain").error(
        "cell_size_m", fmt::format("gives {:.3g} cells and {:.3g} particles, which need about {}; this "
                                   "machine has {}; use larger cells or fewer particles in each",
                                   scene.grid.cells.cast<double>().prod(), cost.particles,
                                   memory_text(cost.bytes), memory_text(limits.memory)));
  }
}

/// Files for other programs are told as what they are.
void refuse_cases_and_suites(const CheckedTable& root) {
  if (root.has("domain")) return;
  if (root.has("kind"))
    throw root.error("kind",
                     "makes this a case of the discrete codes and no scene; talus-dem check reads it");
  if (root.has("case"))
    throw root.error("case", "makes this a suite and no scene; talus-validate list reads it");
}

/// What tables a scene may have is known before any is read: a fault in one must not make others look unknown.
void name_tables(const CheckedTable& root) {
  for (const char* name : {"domain", "material", "wall", "sand", "source", "body", "explosion", "particles",
                           "render_points", "time", "table_5_1", "solver"})
    root.has(name);
}

}  // namespace

Scene read_scene(const std::filesystem::path& file, const SceneLimits& limits) {
  const CheckedTable root = CheckedTable::parse_file(file);
  refuse_cases_and_suites(root);
  root.require_schema(1);
  name_tables(root);
  Scene scene{};
  scene.file = file;
  scene.input_hash = sha256(read_file(file));
  Faults faults;
  const auto read = [&](auto reader) { return passes(faults, reader); };

  const bool domain = read([&] { read_domain(root, limits, scene); });
  const bool materials = read([&] { read_materials(root, scene); });
  const bool particles = read([&] { read_particles(root, scene); });
  read([&] { scene.explosions = read_explosions(root); });
  read([&] { scene.render_points_per_particle = read_render_points(root); });
  read([&] { read_time(root, scene); });
  read([&] { read_table_5_1(root, scene); });
  read([&] {
    if (const auto table = root.optional_table("solver")) scene.broken = read_solver(*table, scene.settings);
  });
  const bool walls = read_walls(root, faults, scene);
  const bool sand = domain && materials && read_fillings(root, faults, scene);
  if (sand && particles && faults.empty()) read([&] { check_size(root, limits, scene); });
  if (domain && walls && faults.empty()) read([&] { check_walls(root, scene); });
  if (domain && walls)
    read([&] { scene.bodies = read_bodies(root, {scene.grid, scene.sides, scene.walls, scene.gravity}); });
  if (sand && walls && particles && read_sources(root, faults, scene) && scene.fillings.empty() &&
      scene.sources.empty())
    faults.push_back(root.error("sand", "there is neither [[sand]] nor a [[source]] of it").what());
  read([&] { root.finish(); });
  refuse(faults);
  return scene;
}

}  // namespace talus
