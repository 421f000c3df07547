#include "continuum/solids/revolved.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace talus {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a[0] * b[1] - a[1] * b[0]; }

struct Segment {
  Eigen::Vector2d from, to;

  bool on_axis() const { return from[0] == 0.0 && to[0] == 0.0; }

  double squared_distance(const Eigen::Vector2d& point) const {
    const Eigen::Vector2d along = to - from;
    const double share = std::clamp((point - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return (point - from - share * along).squaredNorm();
  }
  /// Whether the ray from `point` towards greater r crosses; an end counts with the segment below it.
  bool crossed_by_ray(const Eigen::Vector2d& point) const {
    if ((from[1] > point[1]) == (to[1] > point[1])) return false;
    const double share = (point[1] - from[1]) / (to[1] - from[1]);
    return from[0] + share * (to[0] - from[0]) > point[0];
  }
  /// The side `point` lies on: 1, 0 or -1.
  int side(const Eigen::Vector2d& point) const {
    const double area = cross(to - from, point - from);
    return (area > 0.0) - (area < 0.0);
  }
  /// Whether `point`, known to lie on the line through both ends, lies between them.
  bool spans(const Eigen::Vector2d& point) const {
    return (point - from).dot(to - from) >= 0.0 && (point - to).dot(from - to) >= 0.0;
  }
  bool meets(const Segment& other) const {
    const int a = side(other.from), b = side(other.to), c = other.side(from), d = other.side(to);
    if (a * b < 0 && c * d < 0) return true;
    return (a == 0 && spans(other.from)) || (b == 0 && spans(other.to)) || (c == 0 && other.spans(from)) ||
           (d == 0 && other.spans(to));
  }
};

Segment edge(const std::vector<Eigen::Vector2d>& profile, std::size_t i) {
  return {profile[i], profile[i + 1 < profile.size() ? i + 1 : 0]};
}

std::string text(const Eigen::Vector2d& corner) { return fmt::format("[{}, {}]", corner[0], corner[1]); }

}  // namespace

std::optional<std::string> profile_fault(const std::vector<Eigen::Vector2d>& profile) {
  const std::size_t count = profile.size();
  if (count < 3) return "must have at least three corners";
  for (std::size_t i = 0; i < count; ++i) {
    const auto [from, to] = edge(profile, i);
    if (from[0] < 0.0) return fmt::format("must not pass the axis, as at {}", text(from));
    if (from == to) {
      return fmt::format("must not repeat a corner, as at {}; the last is joined to the first by itself",
                         text(to));
    }
    const Eigen::Vector2d along = to - from, next = edge(profile, (i + 1) % count).to - to;
    if (cross(along, next) == 0.0 && along.dot(next) < 0.0)
      return fmt::format("must not fold back on itself, as at {}", text(to));
  }
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 2; j < count; ++j) {
      if (i == 0 && j + 1 == count) continue;  // neighbours, across the closing
      if (edge(profile, i).meets(edge(profile, j))) {
        return fmt::format("must not cross or touch itself, as the edges from {} and {} do", text(profile[i]),
                           text(profile[j]));
      }
    }
  }
  return std::nullopt;
}

double signed_distance(const Revolved& solid, const Eigen::Vector3d& point) {
  const Eigen::Vector3d offset = point - solid.base;
  const double z = solid.axis.dot(offset);
  const Eigen::Vector2d at((offset - z * solid.axis).norm(), z);
  double squared = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0; i < solid.profile.size(); ++i) {
    const Segment segment = edge(solid.profile, i);
    if (segment.on_axis()) continue;
    squared = std::min(squared, segment.squared_distance(at));
    if (segment.crossed_by_ray(at)) inside = !inside;
  }
  return inside ? -std::sqrt(squared) : std::sqrt(squared);
}

Eigen::AlignedBox3d bounds(const Revolved& solid) {
  // A circle of radius r about the axis a reaches r sqrt(1 - a_i^2) along direction i.
  const Eigen::Vector3d reach = (1.0 - solid.axis.array().square()).max(0.0).sqrt();
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector2d& corner : solid.profile) {
    const Eigen::Vector3d centre = solid.base + corner[1] * solid.axis;
    box.extend(centre - corner[0] * reach);
    box.extend(centre + corner[0] * reach);
  }
  return box;
}

Revolved cone(const Eigen::Vector3d& base, const Eigen::Vector3d& axis, double base_radius, double top_radius,
              double height) {
  return {base, axis, {{0.0, 0.0}, {base_radius, 0.0}, {top_radius, height}, {0.0, height}}};
}

Revolved cylinder(const Eigen::Vector3d& base, const Eigen::Vector3d& axis, double radius, double height) {
  return cone(base, axis, radius, radius, height);
}

std::optional<CylinderSize> cylinder_size(const Revolved& solid) {
  if (solid.profile.size() != 4) return std::nullopt;
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : solid.profile) box.extend(corner);
  if (box.min()[0] != 0.0) return std::nullopt;
  for (const Eigen::Vector2d& corner : solid.profile) {
    const bool of_the_box =
        (corner.array() == box.min().array() || corner.array() == box.max().array()).all();
    if (!of_the_box) return std::nullopt;
  }
  return CylinderSize{box.max()[0], box.sizes()[1], box.min()[1]};
}

Revolved hourglass(const Eigen::Vector3d& base, const Eigen::Vector3d& axis, const HourglassSize& size) {
  const double cone_height = (size.bulb_radius - size.neck_radius) / std::tan(size.cone_half_angle);
  const double neck_low = size.bulb_height + cone_height, neck_high = neck_low + size.neck_length;
  const double height = neck_high + neck_low;
  std::vector<Eigen::Vector2d> profile{{0.0, 0.0},
                                       {size.bulb_radius, 0.0},
                                       {size.bulb_radius, size.bulb_height},
                                       {size.neck_radius, neck_low},
                                       {size.neck_radius, neck_high},
                                       {size.bulb_radius, height - size.bulb_height},
                                       {size.bulb_radius, height},
                                       {0.0, height}};
  profile.erase(std::unique(profile.begin(), profile.end()),
                profile.end());  // no bulb height, no neck length
  return {base, axis, std::move(profile)};
}

}  // namespace talus
