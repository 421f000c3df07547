#include "continuum/solids/body_images.h"

#include <cmath>
#include <limits>

namespace talus {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

Vector3d nearest_image(const Grid& grid, const Vector3d& point, const Vector3d& to) {
  Vector3d image = point;
  for (int axis = 0; axis < 3; ++axis) {
    if (!grid.periodic[static_cast<std::size_t>(axis)]) continue;
    const double period = grid.spacing * grid.cells[axis];
    image[axis] -= period * std::round((point[axis] - to[axis]) / period);
  }
  return image;
}

std::vector<Vector3d> middles(std::span<const Body> bodies) {
  std::vector<Vector3d> found;
  for (const Body& body : bodies) found.push_back(bounds(body).center());
  return found;
}

std::vector<Vector3d> meeting_shifts(const Grid& grid, const AlignedBox3d& box, const AlignedBox3d& place) {
  std::vector<Vector3d> shifts{Vector3d::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    const double ahead = place.max()[axis] - box.min()[axis], behind = place.min()[axis] - box.max()[axis];
    if (!grid.periodic[static_cast<std::size_t>(axis)]) {
      if (ahead < 0.0 || behind > 0.0) return {};
      continue;
    }
    const double period = grid.spacing * grid.cells[axis];
    std::vector<Vector3d> moved;
    for (double turns = std::ceil(behind / period); turns <= ahead / period; ++turns) {
      for (const Vector3d& shift : shifts) moved.emplace_back(shift + turns * period * Vector3d::Unit(axis));
    }
    shifts = std::move(moved);
  }
  return shifts;
}

std::vector<Vector3d> shifts_into_domain(const Grid& grid, const AlignedBox3d& box) {
  AlignedBox3d domain(grid.origin, grid.upper());
  for (int axis = 0; axis < 3; ++axis) {
    if (grid.periodic[static_cast<std::size_t>(axis)]) continue;
    domain.min()[axis] = -std::numeric_limits<double>::infinity();
    domain.max()[axis] = std::numeric_limits<double>::infinity();
  }
  return meeting_shifts(grid, box, domain);
}

Body shifted(Body body, const Vector3d& shift) {
  body.pose.position += shift;
  return body;
}

}  // namespace talus
