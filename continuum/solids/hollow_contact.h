// Contact of a body with what the library's colliders do not do (the inside of a hollow wall, a mesh with a mesh), by points of
// the body's surface and the other's signed distance.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "continuum/solids/body.h"

namespace talus {

/// A place on a body's surface that lies in a solid.
struct SurfaceContact {
  Eigen::Vector3d position;  // m, on the body
  Eigen::Vector3d normal;    // unit vector out of the solid
  double depth;              // m
};

/// From a point in space to the other's surface, m, negative inside.
using DistanceInSpace = std::function<double(const Eigen::Vector3d&)>;

std::vector<SurfaceContact> touch_by_points(const Body& body, const DistanceInSpace& solid);

}  // namespace talus
