#include "continuum/scene/scene.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "continuum/files/provenance.h"
#include "continuum/scene/read_bodies.h"
#include "continuum/scene/read_common.h"
#include "continuum/scene/read_explosions.h"
#include "continuum/scene/read_shape.h"
#include "continuum/scene/read_solver.h"

namespace talus {
namespace {

constexpr double most_cells = 5e7;  // every cell takes some 60 bytes, used or not, and with walls 80 more
constexpr double most_particles = 1e8;
constexpr double most_render_points = 1e9;
constexpr double most_frames = 1e6;
constexpr std::array<std::string_view, 3> axis_names{"x", "y", "z"};

Side read_side(const CheckedTable& table, std::string_view name) {
  constexpr std::array<std::string_view, 2> kinds{"open", "wall"};
  const auto side_table = table.optional_table(name);
  if (!side_table) return {};
  Side side;
  side.wall = side_table->choice("kind", kinds) == "wall";
  if (side.wall) side.friction = read_solid_friction(*side_table);
  side_table->finish();
  return side;
}

Grid read_grid(const CheckedTable& domain) {
  Grid grid;
  grid.origin = domain.vector("origin_m");
  grid.spacing = domain.number("cell_size_m", positive);
  const Eigen::Vector3d size = domain.vector("size_m", positive);
  const Eigen::Vector3d cells = (size / grid.spacing).array().round();
  if (((cells * grid.spacing - size).array().abs() > 1e-6 * grid.spacing).any() ||
      (cells.array() < 1.0).any()) {
    throw domain.error(
        "size_m",
        fmt::format("must be a whole number of cells of cell_size_m = {} along each axis", grid.spacing));
  }
  if (cells.prod() > most_cells)
    throw domain.error("size_m",
                       fmt::format("asks for {:.3g} cells; at most {:.0g}", cells.prod(), most_cells));
  grid.cells = cells.cast<int>();
  grid.periodic = {false, false, false};
  if (domain.has("periodic")) {
    for (const auto& axis : domain.strings("periodic")) {
      const auto found = std::find(axis_names.begin(), axis_names.end(), axis);
      if (found == axis_names.end()) throw domain.error("periodic", "must hold axes: \"x\", \"y\", \"z\"");
      grid.periodic[static_cast<std::size_t>(found - axis_names.begin())] = true;
    }
  }
  return grid;
}

std::vector<Material> read_materials(const CheckedTable& root) {
  std::vector<Material> materials;
  for (const auto& table : root.tables("material")) {
    Material material{};
    material.name = table.string("name");
    material.grain_density = table.number("grain_density_kg_m3", positive);
    material.max_volume_fraction = table.number("max_volume_fraction", {0.1, 0.8});
    const double slowest = table.number("friction_angle_deg", {0.0, largest_friction_angle_deg});
    material.friction = friction_of_angle_deg(slowest);
    if (const auto rate = table.optional_table("rate_dependence")) {
      material.rate.fast_friction = friction_of_angle_deg(
          rate->number("fast_friction_angle_deg", {slowest, largest_friction_angle_deg}));
      material.rate.inertial_number = rate->number("inertial_number", positive);
      material.rate.grain_diameter = rate->number("grain_diameter_m", positive);
      rate->finish();
    }
    table.finish();
    const auto same = [&](const Material& other) { return other.name == material.name; };
    if (std::any_of(materials.begin(), materials.end(), same)) throw table.error("name", "is there twice");
    materials.push_back(material);
  }
  return materials;
}

std::size_t read_material_name(const CheckedTable& table, const std::vector<Material>& materials) {
  const std::string name = table.string("material");
  const auto found =
      std::find_if(materials.begin(), materials.end(), [&](const Material& m) { return m.name == name; });
  if (found == materials.end()) throw table.error("material", "names no [[material]] of this file");
  return static_cast<std::size_t>(found - materials.begin());
}

std::vector<Filling> read_fillings(const CheckedTable& root, const std::vector<Material>& materials,
                                   const Grid& grid) {
  std::vector<Filling> fillings;
  if (!root.has("sand")) return fillings;
  for (const auto& table : root.tables("sand")) {
    Filling filling{read_material_name(table, materials), read_shape(table.table("shape"))};
    if (!holds(grid, bounds(filling.shape))) throw table.error("shape", "must lie inside the domain");
    if (table.has("velocity_m_s")) filling.velocity = table.vector("velocity_m_s");
    table.finish();
    fillings.push_back(filling);
  }
  return fillings;
}

std::vector<Wall> read_walls(const CheckedTable& root) {
  std::vector<Wall> walls;
  if (!root.has("wall")) return walls;
  for (const auto& table : root.tables("wall")) {
    Wall wall{read_shape(table.table("shape")), read_solid_friction(table)};
    wall.opens_at = table.number("opens_at_s", positive, wall.opens_at);
    table.finish();
    walls.push_back(wall);
  }
  return walls;
}

std::vector<Source> read_sources(const CheckedTable& root, const std::vector<Material>& materials,
                                 const std::vector<Wall>& walls, const Grid& grid, double spacing) {
  constexpr std::array<std::string_view, 2> outlines{"rectangle", "ellipse"};
  std::vector<Source> sources;
  if (!root.has("source")) return sources;
  for (const auto& table : root.tables("source")) {
    Source source{};
    source.material = static_cast<int>(read_material_name(table, materials));
    source.lower = table.vector("lower_m");
    source.upper = table.vector("upper_m");
    if (((source.upper - source.lower).array() == 0.0).count() != 1 ||
        (source.upper.array() < source.lower.array()).any())
      throw table.error(
          "upper_m",
          "must equal lower_m along one axis, the inlet's normal, and lie above it along the others");
    if (!holds(grid, {source.lower, source.upper}))
      throw table.error("upper_m", "the inlet must lie inside the domain");
    source.round = table.choice("outline", outlines) == "ellipse";
    source.velocity = table.vector("velocity_m_s");
    if (source.velocity[source.normal()] == 0.0)
      throw table.error("velocity_m_s", "must not be 0 along the inlet's normal");
    source.fill = table.number("fill", {0.01, 1.0}, 1.0);
    source.start = table.number("start_s", non_negative, 0.0);
    source.end = table.number("end_s", positive, std::numeric_limits<double>::infinity());
    if (source.end <= source.start) throw table.error("end_s", "must come after start_s");
    source.spacing = spacing;
    if (!std::isfinite(source.next_layer_time()))
      throw table.error("end_s", "comes before the first layer of sand has entered");
    for (const Eigen::Vector3d& corner :
         {source.lower, source.upper, Eigen::Vector3d(0.5 * (source.lower + source.upper))}) {
      if (nearest_wall(walls, source.start, corner).distance < -1e-9 * grid.spacing)
        throw table.error("upper_m", "the inlet must not lie inside a [[wall]]");
    }
    table.finish();
    sources.push_back(source);
  }
  return sources;
}

/// The grid sees walls at the corners of its cells, and each wall once: one that holds a cell's centre must not slip between
/// them, nor may one that reaches a periodic end differ from what is at the other.
void check_walls(const CheckedTable& root, const Scene& scene) {
  const Grid& grid = scene.grid;
  const auto distance = [&](const Eigen::Vector3d& at) {
    return nearest_wall(scene.walls, 0.0, grid.origin + grid.spacing * at).distance;
  };
  for (int axis = 0; axis < 3 && !scene.walls.empty(); ++axis) {
    if (!grid.periodic[static_cast<std::size_t>(axis)]) continue;
    for (int j = 0; j <= grid.cells[last_axis(axis)]; ++j) {
      for (int i = 0; i <= grid.cells[next_axis(axis)]; ++i) {
        Eigen::Vector3d at = Eigen::Vector3d::Zero();
        at[next_axis(axis)] = i;
        at[last_axis(axis)] = j;
        const double here = distance(at),
                     there = distance(at + grid.cells[axis] * Eigen::Vector3d::Unit(axis));
        if (std::min(here, there) < grid.spacing && std::abs(here - there) > 1e-6 * grid.spacing) {
          throw root.error(
              "wall", fmt::format("the walls must be the same at both ends of the periodic {} axis; near "
                                  "cell ({}, {}) of its end they are not",
                                  axis_names[static_cast<std::size_t>(axis)], i, j));
        }
      }
    }
  }
  const Openings openings = openings_of(grid, scene.walls, 0.0);
  for (int cell = 0; cell < grid.cells.prod() && openings.any(); ++cell) {
    const Eigen::Vector3d centre = grid.cell_of_index(cell).cast<double>().array() + 0.5;
    const double seen = distance_at(grid, openings, grid.origin + grid.spacing * centre).distance;
    if (distance(centre) < -0.05 * grid.spacing && seen > 0.05 * grid.spacing) {
      const Eigen::Vector3d at = grid.origin + grid.spacing * centre;
      throw root.error(
          "wall", fmt::format("a wall near ({:.4g}, {:.4g}, {:.4g}) m is thinner than a cell, and the grid "
                              "would not see it; make it thicker, or cell_size_m smaller",
                              at[0], at[1], at[2]));
    }
  }
}

/// per_cell_axis = n, or per_cell = [nx, ny, nz]: one along an axis is enough where nothing varies along it.
Eigen::Vector3i read_particles_per_cell(const CheckedTable& particles) {
  constexpr int most = 8;
  if (!particles.has("per_cell"))
    return Eigen::Vector3i::Constant(static_cast<int>(particles.integer("per_cell_axis", 2, most)));
  if (particles.has("per_cell_axis"))
    throw particles.error("per_cell", "stands for per_cell_axis; give one of the two");
  return particles.integer_vector("per_cell", 1, most);
}

/// `particles`: of all shapes together, at most.
int read_render_points(const CheckedTable& root, double particles) {
  constexpr int most_per_particle = 1000;
  const auto table = root.optional_table("render_points");
  if (!table) return 0;
  const auto per_particle = static_cast<int>(table->integer("per_particle", 0, most_per_particle));
  if (per_particle * particles > most_render_points) {
    throw table->error("per_particle", fmt::format("gives {:.3g} points; at most {:.0g}",
                                                   per_particle * particles, most_render_points));
  }
  table->finish();
  return per_particle;
}

}  // namespace

Scene read_scene(const std::filesystem::path& file) {
  const CheckedTable root = CheckedTable::parse_file(file);
  root.require_schema(1);
  Scene scene;
  scene.file = file;
  scene.input_hash = sha256(read_file(file));

  const CheckedTable domain = root.table("domain");
  scene.grid = read_grid(domain);
  scene.gravity = domain.vector("gravity_m_s2");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t end = 0; end < 2; ++end) {
      const std::string name = fmt::format("{}_{}", axis_names[axis], end == 0 ? "lower" : "upper");
      scene.sides[axis][end] = read_side(domain, name);
      if (scene.grid.periodic[axis] && domain.has(name))
        throw domain.error(name, "a periodic axis has no sides; remove this");
    }
  }
  domain.finish();

  scene.materials = read_materials(root);
  scene.walls = read_walls(root);
  scene.fillings = read_fillings(root, scene.materials, scene.grid);
  check_walls(root, scene);
  scene.bodies = read_bodies(root, {scene.grid, scene.sides, scene.walls, scene.gravity});
  scene.explosions = read_explosions(root);

  const CheckedTable particles = root.table("particles");
  scene.particles_per_cell = read_particles_per_cell(particles);
  scene.jitter = particles.number("jitter", {0.0, 1.0});
  scene.seed =
      static_cast<std::uint64_t>(particles.integer("seed", 0, std::numeric_limits<std::int64_t>::max()));
  const double per_cell = scene.particles_per_cell.prod();
  double most_at_start = 0.0;
  for (const Filling& filling : scene.fillings) {
    const double count = bounds(filling.shape).sizes().prod() / scene.grid.cell_volume() * per_cell;
    if (count > most_particles) {
      throw particles.error(
          particles.has("per_cell") ? "per_cell" : "per_cell_axis",
          fmt::format("gives {:.3g} particles in one shape; at most {:.0g}", count, most_particles));
    }
    most_at_start += count;
  }
  scene.sources = read_sources(root, scene.materials, scene.walls, scene.grid,
                               scene.grid.spacing / scene.particles_per_cell.maxCoeff());
  if (scene.fillings.empty() && scene.sources.empty())
    throw root.error("sand", "there is neither [[sand]] nor a [[source]] of it");
  constexpr std::array<std::string_view, 2> transfers{"flip", "apic"};
  if (particles.has("transfer") && particles.choice("transfer", transfers) == "apic")
    scene.settings.transfer = Transfer::apic;
  scene.settings.reshape = particles.boolean("split_and_merge", scene.settings.reshape);
  particles.finish();
  scene.render_points_per_particle = read_render_points(root, most_at_start);

  const CheckedTable time = root.table("time");
  scene.end_time = time.number("end_s", positive);
  scene.frame_interval = time.number("frame_interval_s", positive);
  if (scene.end_time / scene.frame_interval > most_frames) {
    throw time.error("frame_interval_s", fmt::format("gives more than {:.0g} frames until end_s = {}",
                                                     most_frames, scene.end_time));
  }
  time.finish();

  if (const auto table = root.optional_table("table_5_1")) {
    scene.table_5_1 =
        SourceFigures{table->number("particles", positive), table->number("render_points", positive),
                      table->number("seconds_per_frame", positive)};
    table->finish();
  }
  if (const auto solver = root.optional_table("solver")) scene.broken = read_solver(*solver, scene.settings);
  root.finish();
  return scene;
}

}  // namespace talus
