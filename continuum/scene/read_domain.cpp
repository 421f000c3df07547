#include "continuum/scene/read_domain.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "continuum/scene/read_common.h"
#include "continuum/scene/read_shape.h"

namespace talus {
namespace {

constexpr std::array<std::string_view, 3> axis_names{"x", "y", "z"};
constexpr Range cell_size_range{1e-6, 1e3};  // m: from a grain of dust to a landslide's cell

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

Grid read_grid(const CheckedTable& domain, double most_cells) {
  Grid grid;
  grid.origin = domain.vector("origin_m", coordinate_range);
  grid.spacing = domain.number("cell_size_m", cell_size_range);
  const Eigen::Vector3d size = domain.vector("size_m", length_range);
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

Wall read_wall(const CheckedTable& table) {
  Wall wall{read_shape(table.table("shape")), read_solid_friction(table)};
  wall.opens_at = table.number("opens_at_s", positive, wall.opens_at);
  table.finish();
  return wall;
}

}  // namespace

void read_domain(const CheckedTable& root, const SceneLimits& limits, Scene& scene) {
  const CheckedTable domain = root.table("domain");
  scene.grid = read_grid(domain, limits.cells);
  scene.gravity = domain.vector("gravity_m_s2", acceleration_range);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t end = 0; end < 2; ++end) {
      const std::string name = fmt::format("{}_{}", axis_names[axis], end == 0 ? "lower" : "upper");
      scene.sides[axis][end] = read_side(domain, name);
      if (scene.grid.periodic[axis] && domain.has(name))
        throw domain.error(name, "a periodic axis has no sides; remove this");
    }
  }
  domain.finish();
}

bool read_walls(const CheckedTable& root, Faults& faults, Scene& scene) {
  bool all = true;
  const bool there = passes(faults, [&] {
    for (const auto& table : up_to_most_tables(root, "wall"))
      all = passes(faults, [&] { scene.walls.push_back(read_wall(table)); }) && all;
  });
  return all && there;
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

}  // namespace talus
