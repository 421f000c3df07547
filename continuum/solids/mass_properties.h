// Volume, centre and inertia of solids of uniform density, and how thick they are.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "continuum/solids/shape.h"

namespace talus {

/// What keeps a shape from being a body, complete but for its subject: "must ..."; nothing for one that can.
std::optional<std::string> body_fault(const Shape& shape);

struct MassProperties {
  double volume;            // m^3
  Eigen::Vector3d centre;   // m
  Eigen::Matrix3d inertia;  // m^5, about the centre, for a density of 1
};

/// To round-off for every shape: in closed form, by line integrals round the profile of a solid of revolution, or by the
/// divergence theorem over the triangles of a mesh. For shapes without a body_fault; throws std::invalid_argument for others.
MassProperties mass_properties(const Shape& shape);

/// Radius of the largest ball that a shape holds, m: half of how thick it is where it is thickest. Within 1 % for solids of
/// revolution that are not cylinders, within the error of the samples for sampled meshes. Throws as above, and for exact meshes.
double inradius(const Shape& shape);
/// How thick a sampled mesh is where it is thinnest, edges aside (thinnest_part); all others 2 inradius. m. Throws as above.
double thinnest(const Shape& shape);

}  // namespace talus
