#include "continuum/grid/free_way.h"

#include <algorithm>

namespace talus {

bool is_free_way(const Grid& grid, const Openings& openings, const Eigen::Vector3d& from,
                 const Eigen::Vector3d& to) {
  if (!openings.any()) return true;
  const Eigen::Vector3d way = to - from;
  const double length = way.norm();
  double left = length;  // of the way, from its end
  do {
    const Eigen::Vector3d at = length > 0.0 ? Eigen::Vector3d(from + left / length * way) : to;
    const double here = distance_at(grid, openings, grid.wrapped_position(at)).distance;
    if (here <= 0.0) return false;
    left -= std::max(here, 0.05 * grid.spacing);
  } while (left > 0.0);
  return true;
}

}  // namespace talus
