// The shapes that solids have: where a point is, as a signed distance d(x) to the surface, exact and in m, d < 0 inside,
// d > 0 outside; so |grad d| = 1 wherever one surface point alone is nearest. Only sampled meshes, which bodies have, are not
// exact (sampled_mesh.h).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <variant>

#include "continuum/solids/mesh.h"
#include "continuum/solids/revolved.h"
#include "continuum/solids/sampled_mesh.h"

namespace talus {

/// A half space: all that lies behind the plane.
struct Plane {
  Eigen::Vector3d point;   // m, anywhere on the plane
  Eigen::Vector3d normal;  // unit vector, out of the solid
};

struct Box {
  Eigen::Vector3d centre;                                  // m
  Eigen::Vector3d half_size;                               // m, along the box's own axes
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  // its columns are the box's own axes
};

struct Sphere {
  Eigen::Vector3d centre;  // m
  double radius;           // m
};

/// All that is nearer than the radius to the segment between two points.
struct Capsule {
  Eigen::Vector3d from, to;  // m
  double radius;             // m
};

struct Shape {
  std::variant<Plane, Box, Sphere, Revolved, Mesh, Capsule, SampledMesh> geometry;
  /// Then the solid is all the space around the geometry, as the glass is around the sand of an hourglass.
  bool hollow = false;
};

/// Distance from `point` (m) to the surface of the solid, m, negative inside it.
double signed_distance(const Shape& shape, const Eigen::Vector3d& point);

/// An axis-aligned box that holds the solid, m: the smallest one, or all space for planes and hollow shapes.
Eigen::AlignedBox3d bounds(const Shape& shape);

}  // namespace talus
