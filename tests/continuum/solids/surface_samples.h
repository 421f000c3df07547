// Points on surfaces, dense enough that the nearest of them stands for the surface: the slow reference for distances.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace talus::testing {

struct SurfaceSamples {
  std::vector<Eigen::Vector3d> points;
  double gap = 0.0;  // every point of the surface is nearer than this to a sample

  double distance(const Eigen::Vector3d& from) const {
    double squared = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& point : points) squared = std::min(squared, (point - from).squaredNorm());
    return std::sqrt(squared);
  }

  /// The parallelogram spanned by u and v, or the half of it next to `corner`.
  void add_patch(const Eigen::Vector3d& corner, const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                 double spacing, bool triangle = false) {
    const int rows = std::max(1, static_cast<int>(std::ceil(u.norm() / spacing)));
    const int columns = std::max(1, static_cast<int>(std::ceil(v.norm() / spacing)));
    for (int i = 0; i <= rows; ++i) {
      for (int j = 0; j <= columns; ++j) {
        const double a = double(i) / rows,
                     b = triangle ? double(j) / columns * (1.0 - a) : double(j) / columns;
        points.push_back(corner + a * u + b * v);
      }
    }
    gap = std::max(gap, u.norm() / rows + v.norm() / columns);
  }

  /// The band that the segment from one (r, z) to another sweeps about `axis`.
  void add_band(const Eigen::Vector3d& base, const Eigen::Vector3d& axis, const Eigen::Vector2d& from,
                const Eigen::Vector2d& to, double spacing) {
    const Eigen::Vector3d e1 = axis.unitOrthogonal(), e2 = axis.cross(e1);
    const int along = std::max(1, static_cast<int>(std::ceil((to - from).norm() / spacing)));
    for (int i = 0; i <= along; ++i) {
      const Eigen::Vector2d at = from + (to - from) * i / along;
      const int around = std::max(1, static_cast<int>(std::ceil(2.0 * std::numbers::pi * at[0] / spacing)));
      for (int j = 0; j < around; ++j) {
        const double angle = 2.0 * std::numbers::pi * j / around;
        points.push_back(base + at[1] * axis + at[0] * (std::cos(angle) * e1 + std::sin(angle) * e2));
      }
    }
    gap = std::max(gap, 1.5 * spacing);
  }
};

}  // namespace talus::testing
