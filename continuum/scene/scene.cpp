#include "continuum/scene/scene.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <random>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "continuum/files/provenance.h"

namespace talus {
namespace {

constexpr double largest_friction_angle_deg = 60.0;
constexpr double most_cells = 5e7;  // every cell takes some 60 bytes, used or not
constexpr double most_particles = 1e8;
constexpr double most_frames = 1e6;
constexpr std::array<std::string_view, 3> axis_names{"x", "y", "z"};

double friction_of_angle_deg(double angle) { return std::tan(angle * std::numbers::pi / 180.0); }

Side read_side(const CheckedTable& table, std::string_view name) {
  constexpr std::array<std::string_view, 2> kinds{"open", "wall"};
  const auto side_table = table.optional_table(name);
  if (!side_table) return {};
  Side side;
  side.wall = side_table->choice("kind", kinds) == "wall";
  if (side.wall)
    side.friction =
        friction_of_angle_deg(side_table->number("friction_angle_deg", {0.0, largest_friction_angle_deg}));
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
    Material material;
    material.name = table.string("name");
    material.grain_density = table.number("grain_density_kg_m3", positive);
    material.max_volume_fraction = table.number("max_volume_fraction", {0.1, 0.8});
    material.friction =
        friction_of_angle_deg(table.number("friction_angle_deg", {0.0, largest_friction_angle_deg}));
    table.finish();
    materials.push_back(material);
  }
  return materials;
}

std::vector<BoxSource> read_boxes(const CheckedTable& root, const std::vector<Material>& materials,
                                  const Grid& grid) {
  std::vector<BoxSource> boxes;
  for (const auto& table : root.tables("box")) {
    const std::string name = table.string("material");
    const auto found =
        std::find_if(materials.begin(), materials.end(), [&](const Material& m) { return m.name == name; });
    if (found == materials.end()) throw table.error("material", "names no [[material]] of this file");
    BoxSource box{static_cast<std::size_t>(found - materials.begin()), table.vector("lower_m"),
                  table.vector("upper_m")};
    if ((box.lower.array() >= box.upper.array()).any())
      throw table.error("upper_m", "must lie above lower_m along every axis");
    const double slack = 1e-9 * grid.spacing;
    if ((box.lower.array() < grid.origin.array() - slack).any() ||
        (box.upper.array() > grid.upper().array() + slack).any()) {
      throw table.error("upper_m", "the box must lie inside the domain");
    }
    table.finish();
    boxes.push_back(box);
  }
  return boxes;
}

ProjectionSettings read_projection(const CheckedTable& solver) {
  ProjectionSettings p;
  p.iterations = static_cast<int>(solver.integer("iterations", 1, 100, p.iterations));
  p.cold_iterations = static_cast<int>(solver.integer("cold_iterations", 1, 100, p.cold_iterations));
  p.tolerance = solver.number("tolerance", {1e-12, 1.0}, p.tolerance);
  p.max_pressure_iterations =
      static_cast<int>(solver.integer("max_pressure_iterations", 1, 1'000'000, p.max_pressure_iterations));
  p.max_friction_iterations =
      static_cast<int>(solver.integer("max_friction_iterations", 1, 1'000'000, p.max_friction_iterations));
  return p;
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
  scene.boxes = read_boxes(root, scene.materials, scene.grid);

  const CheckedTable particles = root.table("particles");
  scene.particles_per_cell = static_cast<int>(particles.integer("per_cell_axis", 2, 8));
  scene.jitter = particles.number("jitter", {0.0, 1.0});
  scene.seed =
      static_cast<std::uint64_t>(particles.integer("seed", 0, std::numeric_limits<std::int64_t>::max()));
  const double per_cell = std::pow(scene.particles_per_cell, 3);
  for (const BoxSource& box : scene.boxes) {
    const double count = (box.upper - box.lower).prod() / scene.grid.cell_volume() * per_cell;
    if (count > most_particles) {
      throw particles.error("per_cell_axis", fmt::format("gives {:.3g} particles in one box; at most {:.0g}",
                                                         count, most_particles));
    }
  }
  particles.finish();

  const CheckedTable time = root.table("time");
  scene.end_time = time.number("end_s", positive);
  scene.frame_interval = time.number("frame_interval_s", positive);
  if (scene.end_time / scene.frame_interval > most_frames) {
    throw time.error("frame_interval_s", fmt::format("gives more than {:.0g} frames until end_s = {}",
                                                     most_frames, scene.end_time));
  }
  time.finish();

  if (const auto solver = root.optional_table("solver")) {
    scene.settings.projection = read_projection(*solver);
    scene.settings.pic_share = solver->number("pic_share", {0.0, 1.0}, scene.settings.pic_share);
    solver->finish();
  }
  root.finish();
  return scene;
}

State initial_state(const Scene& scene) {
  State state{scene.grid, scene.sides, scene.materials, scene.gravity, {}, 0.0, {}, 1.0};
  std::mt19937_64 random(scene.seed);
  // Portable: the standard fixes the engine's numbers, not the distributions'.
  const auto symmetric = [&] { return static_cast<double>(random() >> 11) * 0x1.0p-52 - 1.0; };  // in [-1, 1)

  std::vector<Eigen::Vector3d> positions;
  std::vector<double> masses;
  for (const BoxSource& box : scene.boxes) {
    // A lattice that fills the box exactly, as near to n per cell and axis as whole numbers allow.
    const Eigen::Vector3d size = box.upper - box.lower;
    const Eigen::Vector3d count =
        (size * scene.particles_per_cell / scene.grid.spacing).array().round().max(1.0);
    const Eigen::Vector3d spacing = size.array() / count.array();
    const double mass = spacing.prod() * scene.materials[box.material].max_density();
    for (int k = 0; k < count[2]; ++k) {
      for (int j = 0; j < count[1]; ++j) {
        for (int i = 0; i < count[0]; ++i) {
          Eigen::Vector3d at(i + 0.5, j + 0.5, k + 0.5);
          for (int axis = 0; axis < 3; ++axis) at[axis] += 0.5 * scene.jitter * symmetric();
          positions.push_back(box.lower + at.cwiseProduct(spacing));
          masses.push_back(mass);
          state.particles.materials.push_back(static_cast<int>(box.material));
        }
      }
    }
  }
  const auto n = static_cast<Eigen::Index>(positions.size());
  state.particles.positions = Eigen::Map<Eigen::Matrix3Xd>(positions.front().data(), 3, n);
  state.particles.velocities = Eigen::Matrix3Xd::Zero(3, n);
  state.particles.masses = Eigen::Map<Eigen::ArrayXd>(masses.data(), n);
  return state;
}

}  // namespace talus
