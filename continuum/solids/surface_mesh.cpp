#include "continuum/solids/surface_mesh.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace talus {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

double enclosed_area(const std::vector<Vector2d>& profile) {
  double area = 0.0;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const Vector2d &a = profile[i], &b = profile[(i + 1) % profile.size()];
    area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
  }
  return area;
}

std::vector<Triangle> triangles_of(const Revolved& solid) {
  const Vector3d e1 = solid.axis.unitOrthogonal(), e2 = solid.axis.cross(e1);
  const auto at = [&](const Vector2d& corner, int place) -> Vector3d {
    const double angle = 2.0 * std::numbers::pi * (place % corners_of_a_circle) / corners_of_a_circle;
    return solid.base + corner[1] * solid.axis + corner[0] * (std::cos(angle) * e1 + std::sin(angle) * e2);
  };
  const bool anticlockwise = enclosed_area(solid.profile) > 0.0;
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < solid.profile.size(); ++i) {
    Vector2d from = solid.profile[i], to = solid.profile[(i + 1) % solid.profile.size()];
    if (!anticlockwise) std::swap(from, to);
    for (int place = 0; place < corners_of_a_circle; ++place) {
      const Vector3d a = at(from, place), b = at(from, place + 1), c = at(to, place + 1), d = at(to, place);
      if (from[0] > 0.0) triangles.push_back({a, b, c});
      if (to[0] > 0.0) triangles.push_back({a, c, d});
    }
  }
  return triangles;
}

/// The arc about (0, z) from one angle above the plane of z to another, without its end.
void add_arc(double radius, double z, double from, double to, std::vector<Vector2d>& profile) {
  const int pieces =
      static_cast<int>(std::ceil(corners_of_a_circle * (to - from) / (2.0 * std::numbers::pi) - 1e-9));
  for (int i = 0; i < pieces; ++i) {
    const double angle = from + (to - from) * i / pieces;
    profile.emplace_back(radius * std::cos(angle), z + radius * std::sin(angle));
  }
}

std::vector<Triangle> triangles_of(const Capsule& capsule) {
  const Vector3d along = capsule.to - capsule.from;
  const double length = along.norm(), right_angle = 0.5 * std::numbers::pi;
  std::vector<Vector2d> profile;
  add_arc(capsule.radius, 0.0, -right_angle, 0.0, profile);
  if (length > 0.0) profile.emplace_back(capsule.radius, 0.0);
  add_arc(capsule.radius, length, 0.0, right_angle, profile);
  profile.emplace_back(0.0, length + capsule.radius);
  profile.front()[0] = 0.0;
  const Vector3d axis = length > 0.0 ? Vector3d(along / length) : Vector3d(Vector3d::UnitZ());
  return triangles_of(Revolved{capsule.from, axis, profile});
}

std::vector<Triangle> triangles_of(const Sphere& sphere) {
  return triangles_of(Capsule{sphere.centre, sphere.centre, sphere.radius});
}

std::vector<Triangle> triangles_of(const Box& box) {
  std::vector<Triangle> triangles;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const auto corner = [&](double b, double c) -> Vector3d {
        Vector3d at;
        at[axis] = side;
        at[(axis + 1) % 3] = side * b;  // so that both faces turn outwards
        at[(axis + 2) % 3] = c;
        return box.centre + box.rotation * at.cwiseProduct(box.half_size);
      };
      triangles.push_back({corner(-1, -1), corner(1, -1), corner(1, 1)});
      triangles.push_back({corner(-1, -1), corner(1, 1), corner(-1, 1)});
    }
  }
  return triangles;
}

std::vector<Triangle> triangles_of(const SampledMesh& mesh) { return triangles_of(mesh.samples->mesh); }
std::vector<Triangle> triangles_of(const Plane&) { throw std::invalid_argument("a plane has no end"); }

}  // namespace

std::vector<Triangle> surface_mesh(const Shape& shape) {
  std::vector<Triangle> triangles =
      std::visit([](const auto& geometry) { return triangles_of(geometry); }, shape.geometry);
  if (shape.hollow) {
    for (Triangle& triangle : triangles) std::swap(triangle[1], triangle[2]);
  }
  return triangles;
}

}  // namespace talus
