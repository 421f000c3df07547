// Triangles of shapes: closed, turned outwards, on the surface, and round the same volume.
#include "continuum/solids/surface_mesh.h"

#include <gtest/gtest.h>

#include <map>

#include "continuum/solids/mass_properties.h"
#include "tests/continuum/solids/specimens.h"

namespace talus {
namespace {

using Eigen::Vector3d;

struct ByCoordinates {
  bool operator()(const Vector3d& a, const Vector3d& b) const {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  }
};

/// Edges that are not passed once each way.
int unmatched_edges(const std::vector<Triangle>& triangles) {
  std::map<Vector3d, int, ByCoordinates> numbers;
  std::map<std::pair<int, int>, int> uses;
  for (const Triangle& triangle : triangles) {
    std::array<int, 3> corner{};
    for (std::size_t i = 0; i < 3; ++i)
      corner[i] = numbers.try_emplace(triangle[i], static_cast<int>(numbers.size())).first->second;
    for (std::size_t i = 0; i < 3; ++i) ++uses[{corner[i], corner[(i + 1) % 3]}];
  }
  int unmatched = 0;
  for (const auto& [edge, count] : uses) {
    const auto back = uses.find({edge.second, edge.first});
    if (count != 1 || back == uses.end()) ++unmatched;
  }
  return unmatched;
}

double volume_of(const std::vector<Triangle>& triangles) {
  double volume = 0.0;
  for (const Triangle& t : triangles) volume += t[0].dot(t[1].cross(t[2])) / 6.0;
  return volume;
}

class EverySurface : public ::testing::TestWithParam<testing::SpecimenMaker> {};

TEST_P(EverySurface, IsClosedAndTurnedOutwards) {
  const testing::Specimen specimen = GetParam().make();
  if (std::holds_alternative<Plane>(specimen.shape.geometry)) {
    EXPECT_THROW(surface_mesh(specimen.shape), std::invalid_argument);
    return;
  }
  const std::vector<Triangle> triangles = surface_mesh(specimen.shape);
  EXPECT_EQ(unmatched_edges(triangles), 0);
  for (const Triangle& triangle : triangles) {
    for (const Vector3d& corner : triangle) EXPECT_NEAR(signed_distance(specimen.shape, corner), 0.0, 1e-6);
  }
  const double sign = specimen.shape.hollow ? -1.0 : 1.0;
  const double volume = mass_properties({specimen.shape.geometry}).volume;
  EXPECT_NEAR(sign * volume_of(triangles), volume, 0.005 * volume);
}

INSTANTIATE_TEST_SUITE_P(Solids, EverySurface, ::testing::ValuesIn(testing::specimens()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace talus
