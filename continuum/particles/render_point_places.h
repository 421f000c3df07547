// Where render points may be, and where in their parent's ellipsoid they are.
#pragma once

#include <Eigen/Dense>

#include "continuum/particles/render_points.h"
#include "continuum/particles/sample_ellipsoid.h"

namespace talus {

/// From one position to another, the short way around periodic axes, m.
Eigen::Vector3d short_way(const Grid& grid, const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// A particle as its points see it.
class Parent {
 public:
  Parent(const Surroundings& around, const Particles& particles, Eigen::Index p);

  const Eigen::Vector3d& centre() const { return centre_; }
  /// q^2 of an offset.
  double squared_distance(const Eigen::Vector3d& offset) const {
    const Eigen::Matrix3d& s = inverse_shape_;
    const double x = offset[0], y = offset[1], z = offset[2];
    return x * (s(0, 0) * x + 2.0 * (s(0, 1) * y + s(0, 2) * z)) + y * (s(1, 1) * y + 2.0 * s(1, 2) * z) +
           s(2, 2) * z * z;
  }
  /// Puts a point that is in a wall on it; false where that did not succeed, or the point is too far out.
  bool keeps(Eigen::Vector3d& offset) const {
    return (is_clear(offset) || move_inside(offset)) &&
           squared_distance(offset) <= farthest_offset * farthest_offset;
  }
  /// An offset that is uniform in the ellipsoid where points may be; closer and closer to the centre, where they may be, if
  /// draw after draw lies in walls.
  Eigen::Vector3d sample(Draws draws) const;

 private:
  /// Whether no wall can be there.
  bool is_clear(const Eigen::Vector3d& offset) const { return offset.squaredNorm() < clear_ * clear_; }
  bool move_inside(Eigen::Vector3d& offset) const;
  bool put_inside(Eigen::Vector3d& position) const;

  const Surroundings& around_;
  Eigen::Vector3d centre_;
  Eigen::Matrix3d shape_, inverse_shape_;
  double
      clear_;  // from the centre to the nearest wall or side that is one, at least, m; 0 where the centre is in one
};

}  // namespace talus
