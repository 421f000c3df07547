#include "continuum/solids/hollow_contact.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "continuum/solids/surface_mesh.h"

namespace talus {
namespace {

using Eigen::Vector3d;

// All here is along the body's own axes.

using Distance = std::function<double(const Vector3d&)>;  // to the solid, m

/// A part of a body's surface: all that is as far as `radius` from a point; 0 for the point itself.
struct Ball {
  Vector3d centre;
  double radius;
};

Vector3d outward_normal(const Distance& distance, const Vector3d& at, double step) {
  Vector3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d aside = step * Vector3d::Unit(axis);
    gradient[axis] = distance(at + aside) - distance(at - aside);
  }
  return gradient.stableNormalized();  // zero half-way between two walls, where none pushes
}

std::vector<Ball> parts_of(const Sphere& sphere, const Distance&) { return {{sphere.centre, sphere.radius}}; }

std::vector<Ball> parts_of(const Capsule& capsule, const Distance&) {
  constexpr int intervals = 8;
  std::vector<Ball> parts;
  for (int i = 0; i <= intervals; ++i) {
    const double share = static_cast<double>(i) / intervals;
    parts.push_back({(1.0 - share) * capsule.from + share * capsule.to, capsule.radius});
  }
  return parts;
}

std::vector<Ball> parts_of(const Box& box, const Distance&) {
  constexpr int intervals = 4;
  std::vector<Ball> parts;
  for (int k = 0; k <= intervals; ++k) {
    for (int j = 0; j <= intervals; ++j) {
      for (int i = 0; i <= intervals; ++i) {
        const bool on_surface = i % intervals == 0 || j % intervals == 0 || k % intervals == 0;
        if (!on_surface) continue;
        const Vector3d share = 2.0 / intervals * Vector3d(i, j, k) - Vector3d::Ones();
        parts.push_back({box.centre + box.rotation * share.cwiseProduct(box.half_size), 0.0});
      }
    }
  }
  return parts;
}

/// Of each corner's circle eight points, and the one that reaches furthest into the solid, so that it rolls smoothly.
std::vector<Ball> parts_of(const Revolved& body, const Distance& distance) {
  constexpr int points_of_circle = 8, refinements = 4;
  const Vector3d e1 = body.axis.unitOrthogonal(), e2 = body.axis.cross(e1);
  std::vector<Ball> parts;
  for (const Eigen::Vector2d& corner : body.profile) {
    const Vector3d centre = body.base + corner[1] * body.axis;
    if (corner[0] == 0.0) {
      parts.push_back({centre, 0.0});
      continue;
    }
    Vector3d deepest = centre + corner[0] * e1;
    for (int i = 0; i < points_of_circle; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / points_of_circle;
      const Vector3d at = centre + corner[0] * (std::cos(angle) * e1 + std::sin(angle) * e2);
      parts.push_back({at, 0.0});
      if (distance(at) < distance(deepest)) deepest = at;
    }
    for (int i = 0; i < refinements; ++i) {
      const Vector3d normal = outward_normal(distance, deepest, 1e-6 * corner[0]);
      const Vector3d down = -(normal - body.axis.dot(normal) * body.axis);
      if (down.norm() < 1e-9) break;  // the circle lies along the surface
      const Vector3d next = centre + corner[0] * down.normalized();
      if (distance(next) > distance(deepest)) break;
      deepest = next;
    }
    parts.push_back({deepest, 0.0});
  }
  return parts;
}

/// Corners, and a lattice between them where triangles are large: two flat sides may meet without a corner in either.
std::vector<Ball> points_of(const std::vector<Triangle>& triangles, double body_size) {
  constexpr double coarsest = 1.0 / 8.0;  // of the body's size
  std::vector<Ball> parts;
  for (const Triangle& t : triangles) {
    const double longest = std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
    const int n = std::max(1, static_cast<int>(std::ceil(longest / (coarsest * body_size))));
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; i + j <= n; ++j) {
        const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
        parts.push_back({(1.0 - u - v) * t[0] + u * t[1] + v * t[2], 0.0});
      }
    }
  }
  return parts;
}

}  // namespace

std::vector<SurfaceContact> touch_by_points(const Body& body, const DistanceInSpace& solid) {
  const Eigen::Matrix3d rotation = body.pose.orientation.toRotationMatrix();
  const auto in_space = [&](const Vector3d& at) -> Vector3d { return rotation * at + body.pose.position; };
  const Distance distance = [&](const Vector3d& at) { return solid(in_space(at)); };
  const double body_size = bounds(body.shape).sizes().maxCoeff();
  const std::vector<Ball> parts = std::visit(
      [&](const auto& geometry) -> std::vector<Ball> {
        if constexpr (requires { parts_of(geometry, distance); })
          return parts_of(geometry, distance);
        else
          return points_of(surface_mesh({geometry}), body_size);
      },
      body.shape.geometry);
  const double step = 1e-6 * body_size;
  std::vector<SurfaceContact> contacts;
  for (const Ball& part : parts) {
    const double depth = part.radius - distance(part.centre);
    if (depth < 0.0) continue;
    const Vector3d normal = outward_normal(distance, part.centre, step);
    if (normal.isZero()) continue;
    contacts.push_back({in_space(part.centre - part.radius * normal), rotation * normal, depth});
  }
  return contacts;
}

}  // namespace talus
