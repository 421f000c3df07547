// Shapes as triangles: for pictures, and for the contact of shapes that the collision library does not know.
#pragma once

#include <vector>

#include "continuum/solids/shape.h"

namespace talus {

/// What is round becomes a polygon of so many corners, inscribed: off by at most 0.12 % of the radius.
inline constexpr int corners_of_a_circle = 64;

/// A closed surface, counter-clockwise seen from outside the solid (of hollow shapes: from inside the cavity). Throws
/// std::invalid_argument for a plane, which has no end.
std::vector<Triangle> surface_mesh(const Shape& shape);

}  // namespace talus
