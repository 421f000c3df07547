// STL and OBJ files, read strictly. Read here and not by a library: assimp leaked on a text STL that was cut off,
// tells no line, and fuzzing cannot see into it; CGAL merges vertices that are no numbers with others, silently.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <vector>

namespace talus {

/// Triangles as files have them: nobody knows yet which are neighbours.
struct TriangleSoup {
  std::vector<Eigen::Vector3f> points;  // may be no finite numbers
  std::vector<std::array<std::size_t, 3>> triangles;
};

inline constexpr double largest_mesh_file = 4e8;  // bytes
inline constexpr std::size_t most_triangles = 2'000'000;

/// By the ending of its name: STL, binary or text, or OBJ, each face of which must be seen whole from one of its corners, as convex ones are. Throws
/// InputError naming the file, the line of a text, what is wrong and what to do.
TriangleSoup read_triangles_of_file(const std::filesystem::path& file);

}  // namespace talus
