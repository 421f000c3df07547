// One of each shape, with what it is told by other means: points on its surface, and whether a point is inside.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "continuum/solids/shape.h"
#include "tests/continuum/solids/surface_samples.h"

namespace talus::testing {

struct Specimen {
  Shape shape;
  SurfaceSamples surface;
  std::function<bool(const Eigen::Vector3d&)> inside;
};

struct SpecimenMaker {
  std::string name;
  Specimen (*make)();
};

/// All of them, some 1 m in size and within 2 m of the origin.
std::vector<SpecimenMaker> specimens();

}  // namespace talus::testing
