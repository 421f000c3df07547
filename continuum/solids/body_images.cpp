#include "continuum/solids/body_images.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "continuum/numerical_faults.h"

namespace talus {
namespace {

constexpr double most_turns = 1e9;   // periods away from the domain
constexpr double most_shifts = 1e3;  // along an axis

}  // namespace

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
    if (!(std::max(std::abs(ahead), std::abs(behind)) <= most_turns * period) ||
        ahead - behind > most_shifts * period) {
      throw NumericalError(fmt::format(
          "a body between {:.3g} and {:.3g} m along an axis with a period of {:.3g} m is too far away, "
          "too large or too fast",
          box.min()[axis], box.max()[axis], period));
    }
    std::vector<Vector3d> moved;
    const int last = static_cast<int>(std::floor(ahead / period));
    for (int turns = static_cast<int>(std::ceil(behind / period)); turns <= last; ++turns) {
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
