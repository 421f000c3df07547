// Surfaces as binary STL, which every viewer reads.
#pragma once

#include <span>
#include <string>

#include "continuum/solids/mesh.h"

namespace talus {

/// The content of a file: coordinates in single precision, normals from the corners.
std::string binary_stl(std::span<const Triangle> triangles);

}  // namespace talus
