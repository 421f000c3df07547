// Solids of revolution: a polygon in the half plane r >= 0, turned about an axis. With z = a.(x - b) and
// r = |x - b - z a| for base b and axis a, the nearest point of such a surface lies in the half plane of x itself, so
// the distance in space is the distance in (r, z); it is exact.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

namespace talus {

struct Revolved {
  Eigen::Vector3d base;  // m, where r = z = 0
  Eigen::Vector3d axis;  // unit vector along increasing z
  /// (r, z) of the corners, m, r >= 0; closed from last to first, in either sense. An edge on the axis is no surface.
  std::vector<Eigen::Vector2d> profile;
};

/// What keeps `profile` from bounding a solid, complete but for its subject: "must ..."; nothing when it is sound.
/// Looked for: fewer than three corners, r < 0, repeated corners, edges that fold back, cross or touch.
std::optional<std::string> profile_fault(const std::vector<Eigen::Vector2d>& profile);

/// Distance to the surface, m, negative inside.
double signed_distance(const Revolved& solid, const Eigen::Vector3d& point);
/// The smallest axis-aligned box that holds the solid, m.
Eigen::AlignedBox3d bounds(const Revolved& solid);

// The common ones, standing on `base` and rising along the unit vector `axis`; lengths in m.

/// A frustum, or a cone when one of the radii is zero.
Revolved cone(const Eigen::Vector3d& base, const Eigen::Vector3d& axis, double base_radius, double top_radius,
              double height);
Revolved cylinder(const Eigen::Vector3d& base, const Eigen::Vector3d& axis, double radius, double height);

/// Of a solid whose profile is a rectangle on the axis; nothing for others.
struct CylinderSize {
  double radius, height;  // m
  double bottom;          // m, z of its lower end
};
std::optional<CylinderSize> cylinder_size(const Revolved& solid);

/// From the base up: a cylindrical bulb, a cone that narrows to the neck, the cylindrical neck, and both mirrored.
struct HourglassSize {
  double bulb_radius, bulb_height;  // m, of the cylindrical part of each bulb; the height may be zero
  double neck_radius, neck_length;  // m, radius less than the bulb's; the length may be zero
  double cone_half_angle;           // rad, between the wall of a cone and the axis; in (0, pi/2)
};
Revolved hourglass(const Eigen::Vector3d& base, const Eigen::Vector3d& axis, const HourglassSize& size);

}  // namespace talus
