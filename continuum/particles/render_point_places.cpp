#include "continuum/particles/render_point_places.h"

#include <limits>

namespace talus {
namespace {

using Eigen::Vector3d;

constexpr int most_draws = 24, whole_draws = 8;  // from the whole ellipsoid, then from ever smaller ones
constexpr int put_back_rounds = 3;               // where walls meet, coming off one can lead into the other

/// To the nearest wall or side that is one, and beyond it. A position outside the domain is seen from the nearest inside.
DistanceAndGradient distance_of_walls(const Surroundings& around, const Vector3d& position) {
  const double inset = 1e-9 * around.grid.spacing;
  const Vector3d wrapped = around.grid.wrapped_position(position);
  const Vector3d inside = wrapped.cwiseMax((around.grid.origin.array() + inset).matrix())
                              .cwiseMin((around.grid.upper().array() - inset).matrix());
  DistanceAndGradient found = distance_at(around.grid, around.openings, inside);
  found.distance += found.gradient.dot(wrapped - inside);
  return found;
}

/// Puts it on the sides that are walls, if it is beyond; returns whether it was.
bool put_on_sides(const Surroundings& around, Vector3d& position) {
  const Vector3d before = position, upper = around.grid.upper();
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    if (around.grid.periodic[a]) continue;
    if (around.sides[a][0].wall) position[axis] = std::max(position[axis], around.grid.origin[axis]);
    if (around.sides[a][1].wall) position[axis] = std::min(position[axis], upper[axis]);
  }
  return position != before;
}

double clear_distance(const Surroundings& around, const Vector3d& centre) {
  constexpr double of_distance = 0.8;  // between corners of cells, distances are not quite so
  double least = std::numeric_limits<double>::infinity();
  if (around.openings.any()) least = of_distance * distance_of_walls(around, centre).distance;
  const Vector3d upper = around.grid.upper();
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    if (around.grid.periodic[a]) continue;
    if (around.sides[a][0].wall) least = std::min(least, centre[axis] - around.grid.origin[axis]);
    if (around.sides[a][1].wall) least = std::min(least, upper[axis] - centre[axis]);
  }
  return std::max(0.0, least);
}

}  // namespace

Vector3d short_way(const Grid& grid, const Vector3d& from, const Vector3d& to) {
  Vector3d way = to - from;
  for (int axis = 0; axis < 3; ++axis) {
    if (!grid.periodic[static_cast<std::size_t>(axis)]) continue;
    const double length = grid.spacing * grid.cells[axis];
    way[axis] -= length * std::round(way[axis] / length);
  }
  return way;
}

Parent::Parent(const Surroundings& around, const Particles& particles, Eigen::Index p)
    : around_(around),
      centre_(particles.positions.col(p)),
      shape_(shape_matrix(particles, p)),
      inverse_shape_(shape_.inverse()),
      clear_(clear_distance(around, centre_)) {}

bool Parent::put_inside(Vector3d& position) const {
  put_on_sides(around_, position);
  if (!around_.openings.any()) return true;
  for (int round = 0; round < put_back_rounds; ++round) {
    const auto [distance, gradient] = distance_of_walls(around_, position);
    if (distance >= 0.0) return true;
    if (gradient.squaredNorm() == 0.0) return false;
    position += (1e-6 * around_.grid.spacing - distance) / gradient.squaredNorm() * gradient;
    put_on_sides(around_, position);
  }
  return distance_of_walls(around_, position).distance >= 0.0;
}

bool Parent::move_inside(Vector3d& offset) const {
  const Vector3d before = centre_ + offset;
  Vector3d position = before;
  if (!put_inside(position)) return false;
  offset += position - before;  // 0, exactly, where it was inside
  return true;
}

Vector3d Parent::sample(Draws draws) const {
  const Eigen::Matrix3d map = map_of_ball(shape_);
  double scale = 1.0;
  for (int draw = 0; draw < most_draws; ++draw) {
    if (draw >= whole_draws) scale *= 0.75;
    Vector3d offset = scale * map * draws.in_ball();
    if (is_clear(offset)) return offset;
    Vector3d position = centre_ + offset;
    if (!put_on_sides(around_, position) &&
        !(around_.openings.any() && distance_of_walls(around_, position).distance < 0.0))
      return offset;
  }
  return Vector3d::Zero();
}

}  // namespace talus
