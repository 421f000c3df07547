#include "continuum/scene/read_domain.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

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

namespace {

using CellDistance = std::function<double(const Eigen::Vector3d&)>;  // all in cells

/// Whether the way across a cell along an axis, from a place on its lower side, leads through a wall that holds neither end.
bool slips_between(const CellDistance& distance, const Eigen::Vector3d& start, int axis) {
  constexpr double least_depth = 1e-3;  // and the shortest stride
  const Eigen::Vector3d way = Eigen::Vector3d::Unit(axis);
  double here = distance(start);
  if (here <= 0.0 || distance(start + way) <= 0.0) return false;
  double gone = 0.0;
  while (here >= -least_depth) {
    gone += std::max(here, least_depth);
    if (gone >= 1.0) return false;
    here = distance(start + gone * way);
  }
  return true;
}

/// Whether a wall leads right across a cell without holding one of its corners.
bool plate_between(const CellDistance& distance, const Eigen::Vector3d& cell) {
  constexpr double at_surface = 1e-9;  // where the grid takes a corner to be on a wall
  for (int c = 0; c < 8; ++c) {
    if (distance(cell + Eigen::Vector3d(c & 1, c >> 1 & 1, c >> 2)) <= at_surface) return false;
  }
  const auto across = [&](int axis) {
    const Eigen::Vector3d u = Eigen::Vector3d::Unit(next_axis(axis)),
                          v = Eigen::Vector3d::Unit(last_axis(axis));
    for (const double i : {0.25, 0.75}) {
      for (const double j : {0.25, 0.75}) {
        if (!slips_between(distance, cell + i * u + j * v, axis)) return false;
      }
    }
    return true;
  };
  return across(0) || across(1) || across(2);
}

/// Whether a wall is nowhere near a place in it half a cell deep, as it is behind the edges of whatever is thick.
bool thin_around(const CellDistance& distance, Eigen::Vector3d place) {
  constexpr double stride = 0.25;
  double deepest = distance(place);
  for (int step = 0; step < 8 && deepest > -0.5; ++step) {
    const Eigen::Vector3d from = place;
    for (int n = 0; n < 27; ++n) {
      const Eigen::Vector3d way = (Eigen::Array3i(n % 3, n / 3 % 3, n / 9) - 1).cast<double>();
      if (const double there = distance(from + stride * way); there < deepest) {
        deepest = there;
        place = from + stride * way;
      }
    }
    if (place == from) break;
  }
  return deepest > -0.5;
}

}  // namespace

/// The grid sees walls at the corners of its cells, and each wall once: one that holds a cell's centre, or leads right across a
/// cell, must not slip between them, nor may one that reaches a periodic end differ from what is at the other.
void check_walls(const CheckedTable& root, const Scene& scene) {
  const Grid& grid = scene.grid;
  const CellDistance distance = [&](const Eigen::Vector3d& at) {
    return nearest_wall(scene.walls, 0.0, grid.origin + grid.spacing * at).distance / grid.spacing;
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
        if (std::min(here, there) < 1.0 && std::abs(here - there) > 1e-6) {
          throw root.error(
              "wall", fmt::format("the walls must be the same at both ends of the periodic {} axis; near "
                                  "cell ({}, {}) of its end they are not",
                                  axis_names[static_cast<std::size_t>(axis)], i, j));
        }
      }
    }
  }
  const Openings openings = openings_of(grid, scene.walls, 0.0);
  for (int n = 0; n < grid.cells.prod() && openings.any(); ++n) {
    const Eigen::Vector3d cell = grid.cell_of_index(n).cast<double>(), centre = cell.array() + 0.5;
    const Eigen::Vector3d at = grid.origin + grid.spacing * centre;
    const double here = distance(centre), seen = distance_at(grid, openings, at).distance / grid.spacing;
    const bool may_hold_a_wall = std::abs(here) <= 0.5 * std::numbers::sqrt3;
    if ((here < -0.05 && seen > 0.05 && thin_around(distance, centre)) ||
        (may_hold_a_wall && plate_between(distance, cell))) {
      throw root.error(
          "wall", fmt::format("a wall near ({:.4g}, {:.4g}, {:.4g}) m is thinner than a cell, and the grid "
                              "would not see it; make it thicker, or cell_size_m smaller",
                              at[0], at[1], at[2]));
    }
  }
}

}  // namespace talus
