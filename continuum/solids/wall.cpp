#include "continuum/solids/wall.h"

#include <algorithm>

namespace talus {

WallDistance nearest_wall(std::span<const Wall> walls, double time, const Eigen::Vector3d& position) {
  WallDistance nearest{std::numeric_limits<double>::infinity(), 0.0};
  for (const Wall& wall : walls) {
    if (!wall.stands_at(time)) continue;
    const double distance = signed_distance(wall.shape, position);
    if (distance < nearest.distance) nearest = {distance, wall.friction};
  }
  return nearest;
}

Openings openings_of(const Grid& grid, std::span<const Wall> walls, double time) {
  if (std::none_of(walls.begin(), walls.end(), [&](const Wall& wall) { return wall.stands_at(time); }))
    return {};
  return make_openings(grid,
                       [&](const Eigen::Vector3d& position) { return nearest_wall(walls, time, position); });
}

double next_opening(std::span<const Wall> walls, double time) {
  double next = std::numeric_limits<double>::infinity();
  for (const Wall& wall : walls) {
    if (wall.opens_at > time) next = std::min(next, wall.opens_at);
  }
  return next;
}

}  // namespace talus
