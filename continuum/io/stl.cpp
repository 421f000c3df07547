#include "continuum/io/stl.h"

#include <bit>
#include <cstdint>

namespace talus {
namespace {

static_assert(std::endian::native == std::endian::little, "STL is little-endian");

template <class Value>
void put(const Value& value, std::string& file) {
  file.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void put_vector(const Eigen::Vector3d& vector, std::string& file) {
  for (const double value : vector) put(static_cast<float>(value), file);
}

}  // namespace

std::string binary_stl(std::span<const Triangle> triangles) {
  constexpr std::size_t header_length = 80;
  std::string file =
      "Surface of a body, m, by talus";  // must not start with "solid": that is how text files start
  file.resize(header_length, ' ');
  put(static_cast<std::uint32_t>(triangles.size()), file);
  for (const Triangle& triangle : triangles) {
    put_vector((triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalized(), file);
    for (const Eigen::Vector3d& corner : triangle) put_vector(corner, file);
    put(std::uint16_t{0}, file);
  }
  return file;
}

}  // namespace talus
