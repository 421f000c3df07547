// Surfaces as STL, by reading them back.
#include "continuum/io/stl.h"

#include <gtest/gtest.h>

#include "continuum/files/atomic_file.h"
#include "continuum/solids/mass_properties.h"
#include "continuum/solids/surface_mesh.h"
#include "tests/test_folder.h"

namespace talus {
namespace {

TEST(Stl, ComesBackAsTheSameSolid) {
  const testing::TestFolder folder;
  const Shape cylinder_shape{cylinder({0.1, 0.2, 0.3}, Eigen::Vector3d(2, -1, 2) / 3.0, 0.05, 0.2)};
  const std::vector<Triangle> triangles = surface_mesh(cylinder_shape);
  const std::string content = binary_stl(triangles);
  EXPECT_EQ(content.size(), 84 + 50 * triangles.size());
  write_file_atomically(folder.path() / "cylinder.stl", content);
  const Mesh mesh = read_mesh(folder.path() / "cylinder.stl");  // closed, manifold, turned outwards
  EXPECT_EQ(triangles_of(mesh).size(), triangles.size());
  const double volume = mass_properties(cylinder_shape).volume;
  EXPECT_NEAR(mass_properties({mesh}).volume, volume, 0.003 * volume);
}

}  // namespace
}  // namespace talus
