#include "continuum/scene/narrow_openings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace talus {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double never = std::numeric_limits<double>::max();
constexpr int sides_of_a_domain = 6;
constexpr double least_difference = 1.5;  // cells, between d in the middle of a room and in the passage
constexpr double least_gap = 0.05;        // cells, from a wall: nearer, two walls are meant to touch
constexpr double surface = 1e-3;          // cells: nearer to a wall than this is at it

/// Distance to what keeps sand in, for good.
struct Confinement {
  const Grid& grid;
  const DomainSides& sides;
  std::span<const Wall> walls;

  double operator()(const Vector3d& at) const {
    double distance = nearest_wall(walls, never, at).distance;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      if (grid.periodic[a]) continue;
      if (sides[a][0].wall) distance = std::min(distance, at[axis] - grid.origin[axis]);
      if (sides[a][1].wall) distance = std::min(distance, grid.upper()[axis] - at[axis]);
    }
    return distance;
  }
};

/// The corners of cells; the six numbers beyond theirs stand for what is outside each side of the domain.
struct Corners {
  const Grid& grid;
  const DomainSides& sides;
  Vector3i extent = grid.extent({true, true, true});

  int count() const { return extent.prod(); }
  Vector3i place(int n) const {
    return {n % extent[0], n / extent[0] % extent[1], n / (extent[0] * extent[1])};
  }
  Vector3d position(int n) const { return grid.origin + grid.spacing * place(n).cast<double>(); }

  /// Calls visit(m) for each neighbour m of corner n along the axes.
  template <class Visit>
  void for_neighbours(int n, Visit visit) const {
    const Vector3i at = place(n);
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const int stride = axis == 0 ? 1 : axis == 1 ? extent[0] : extent[0] * extent[1];
      for (const int step : {-1, 1}) {
        const int next = at[axis] + step;
        if (next >= 0 && next < extent[axis])
          visit(n + step * stride);
        else if (grid.periodic[a])
          visit(n - step * (extent[axis] - 1) * stride);
        else if (!sides[a][step > 0 ? 1 : 0].wall)
          visit(count() + 2 * axis + (step > 0 ? 1 : 0));
      }
    }
  }
};

/// Rooms that grow into each other.
class Rooms {
 public:
  explicit Rooms(int count) : parent_(static_cast<std::size_t>(count)), widest_(parent_.size(), 0.0) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int find(int n) {
    while (parent(n) != n) n = parent(n) = parent(parent(n));
    return n;
  }
  double& widest(int root) { return widest_[static_cast<std::size_t>(root)]; }
  void join(int first, int second) {
    parent(second) = first;
    widest(first) = std::max(widest(first), widest(second));
  }

 private:
  int& parent(int n) { return parent_[static_cast<std::size_t>(n)]; }
  std::vector<int> parent_;
  std::vector<double> widest_;  // largest d of a room, at its root
};

/// Corners where two rooms meet at a distance below `largest`.
std::vector<int> saddles(const Corners& corners, const std::vector<double>& distance, double largest) {
  const int inside = corners.count(), all = inside + sides_of_a_domain;
  const double spacing = corners.grid.spacing;
  std::vector<int> found, order;
  for (int n = 0; n < inside; ++n) {
    if (distance[static_cast<std::size_t>(n)] > 0.0) order.push_back(n);
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return distance[static_cast<std::size_t>(a)] > distance[static_cast<std::size_t>(b)];
  });
  Rooms rooms(all);
  std::vector<bool> there(static_cast<std::size_t>(all), false);
  for (int side = inside; side < all; ++side) {
    rooms.widest(side) = std::numeric_limits<double>::infinity();
    there[static_cast<std::size_t>(side)] = true;
  }
  for (const int n : order) {
    const double here = distance[static_cast<std::size_t>(n)];
    there[static_cast<std::size_t>(n)] = true;
    rooms.widest(n) = here;
    corners.for_neighbours(n, [&](int next) {
      if (!there[static_cast<std::size_t>(next)]) return;
      const int mine = rooms.find(n), other = rooms.find(next);
      if (mine == other) return;
      const double narrower = std::min(rooms.widest(mine), rooms.widest(other));
      if (here < largest && narrower - here >= least_difference * spacing) found.push_back(n);
      rooms.join(mine, other);
    });
  }
  return found;
}

/// The way to the n-th of the 27 cells around one and itself, which is the 13th.
Vector3d neighbour(int n) { return (Eigen::Array3i(n % 3, n / 3 % 3, n / 9) - 1).cast<double>(); }

/// The way to the nearest wall, of unit length: by the gradient beside the place, for in the middle between two walls there is none.
Vector3d towards_wall(const Confinement& distance, const Vector3d& at, double spacing) {
  Vector3d best = Vector3d::UnitX();
  double least = never;
  for (int n = 0; n < 27; ++n) {
    const Vector3d way = neighbour(n);
    if (way.isZero()) continue;
    const double there = distance(at + 0.25 * spacing * way.normalized());
    if (there < least) {
      least = there;
      best = way.normalized();
    }
  }
  const double small = 0.01 * spacing;
  const Vector3d beside = at + 0.25 * spacing * best;
  Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis)
    gradient[axis] =
        distance(beside + small * Vector3d::Unit(axis)) - distance(beside - small * Vector3d::Unit(axis));
  return gradient.norm() > 0.5 * small ? Vector3d(-gradient.normalized()) : best;
}

/// How far it is from a place to a wall along a way, m; at most `longest`. No step is longer than the distance, so none jumps a wall.
double way_to_wall(const Confinement& distance, const Vector3d& from, const Vector3d& way, double longest,
                   double spacing) {
  double gone = 0.0;
  while (gone < longest) {
    const double free = distance(from + gone * way);
    if (free < surface * spacing) return gone + std::max(free, 0.0);
    gone += free;
  }
  return longest;
}

/// From wall to wall along a line through a place; of width `longest` where it meets no wall on both sides by then.
NarrowOpening chord(const Confinement& distance, const Vector3d& at, const Vector3d& way, double longest,
                    double spacing) {
  const double there = way_to_wall(distance, at, way, longest, spacing),
               back = way_to_wall(distance, at, -way, longest, spacing);
  return {at + 0.5 * (there - back) * way, std::min(there + back, longest)};
}

/// From wall to wall through a saddle: square to the nearest wall or, where that leads out past the edge of the other one, the shortest
/// of the grid's 13 directions. A corner lies up to sqrt(3)/2 cells from the saddle, which bounds what can be right.
NarrowOpening opening_at(const Confinement& distance, const Vector3d& at, double spacing) {
  const double longest = 2.0 * (distance(at) + std::sqrt(3.0) * 0.5 * spacing);
  NarrowOpening opening = chord(distance, at, towards_wall(distance, at, spacing), longest, spacing);
  if (opening.width < longest) return opening;
  for (int n = 0; n < 13; ++n) {
    const Vector3d way = neighbour(n).normalized();
    const NarrowOpening other = chord(distance, at, way, longest, spacing);
    if (other.width < opening.width) opening = other;
  }
  return opening;
}

/// Corners of the cell at `cell`, by number.
std::array<int, 8> corners_of(const Grid& grid, const Corners& corners, const Vector3i& cell) {
  std::array<int, 8> numbers;
  for (int c = 0; c < 8; ++c) {
    Vector3i at = cell + Vector3i(c & 1, c >> 1 & 1, c >> 2);
    for (int axis = 0; axis < 3; ++axis) at[axis] = grid.wrapped(axis, at[axis]);
    numbers[static_cast<std::size_t>(c)] = at[0] + corners.extent[0] * (at[1] + corners.extent[1] * at[2]);
  }
  return numbers;
}

/// A place between walls in a cell no corner of which is: to the grid, the walls touch there.
std::optional<Vector3d> unseen_gap(const Confinement& distance, const Corners& corners,
                                   const std::vector<double>& at_corners) {
  const Grid& grid = distance.grid;
  for (int n = 0; n < grid.cells.prod(); ++n) {
    const Vector3i cell = grid.cell_of_index(n);
    double nearest = -never;
    for (const int corner : corners_of(grid, corners, cell))
      nearest = std::max(nearest, at_corners[static_cast<std::size_t>(corner)]);
    if (nearest > 0.0 || nearest < -0.5 * grid.spacing) continue;
    for (int c = 0; c < 8; ++c) {
      const Vector3d quarter = 0.25 * Vector3d(1 + 2 * (c & 1), 1 + 2 * (c >> 1 & 1), 1 + 2 * (c >> 2));
      const Vector3d at = grid.origin + grid.spacing * (cell.cast<double>() + quarter);
      if (distance(at) > least_gap * grid.spacing) return at;
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<NarrowOpening> narrow_openings(const Grid& grid, const DomainSides& sides,
                                           std::span<const Wall> walls, double least_width) {
  if (walls.empty()) return {};
  const Confinement confinement{grid, sides, walls};
  const Corners corners{grid, sides};
  std::vector<double> distance(static_cast<std::size_t>(corners.count()));
  for (int n = 0; n < corners.count(); ++n)
    distance[static_cast<std::size_t>(n)] = confinement(corners.position(n));
  std::vector<NarrowOpening> found;
  for (const int n : saddles(corners, distance, 0.5 * least_width)) {
    const NarrowOpening opening = opening_at(confinement, corners.position(n), grid.spacing);
    if (opening.width < least_width * (1.0 - surface)) found.push_back(opening);
  }
  if (const auto gap = unseen_gap(confinement, corners, distance))
    found.push_back(opening_at(confinement, *gap, grid.spacing));
  std::ranges::sort(found, {}, &NarrowOpening::width);
  return found;
}

}  // namespace talus
