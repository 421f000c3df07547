// Contact of a body with the inside of a hollow wall, by points of the body's surface and the wall's own distance.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "continuum/solids/body.h"

namespace talus {

/// A place on a body's surface that lies in a solid.
struct SurfaceContact {
  Eigen::Vector3d position;  // m, on the body
  Eigen::Vector3d normal;    // unit vector out of the solid
  double depth;              // m
};

std::vector<SurfaceContact> touch_by_points(const Body& body, const Shape& solid);

}  // namespace talus
