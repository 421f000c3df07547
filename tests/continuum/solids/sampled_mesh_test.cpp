// Looked-up distances against searched ones: below the bound that is proved everywhere, and much below it where the surface is flat.
#include "continuum/solids/sampled_mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>

#include "continuum/solids/mass_properties.h"
#include "tests/continuum/solids/mesh_files.h"
#include "tests/test_folder.h"

namespace talus {
namespace {

using Eigen::Vector3d;

Mesh mesh_of(const testing::Triangles& triangles) {
  const testing::TestFolder folder;
  testing::write_text_stl(folder.path() / "mesh.stl", triangles);
  return read_mesh(folder.path() / "mesh.stl");
}

struct Errors {
  double largest = 0.0, largest_near_surface = 0.0;  // in spacings
};

Errors errors_of(const Mesh& mesh, int intervals) {
  const SampledMesh sampled = sample_distances(mesh, intervals);
  const double spacing = sampled.samples->spacing;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> share(-0.05, 1.05);
  Errors errors;
  for (int i = 0; i < 20000; ++i) {
    const Vector3d at = bounds(mesh).min() + bounds(mesh).sizes().cwiseProduct(
                                                 Vector3d(share(random), share(random), share(random)));
    const double exact = signed_distance(mesh, at);
    const double error = std::abs(signed_distance(sampled, at) - exact) / spacing;
    errors.largest = std::max(errors.largest, error);
    if (std::abs(exact) < spacing) errors.largest_near_surface = std::max(errors.largest_near_surface, error);
  }
  return errors;
}

TEST(SampledMesh, ErrorOfABoxIsThatOfItsEdges) {
  const Errors errors = errors_of(mesh_of(testing::box_mesh({0, 0, 0}, {1.03, 0.71, 0.53})), 20);
  EXPECT_LT(errors.largest, std::sqrt(3.0) / 2.0);
  EXPECT_LT(errors.largest_near_surface, 0.45);
  EXPECT_GT(errors.largest_near_surface, 0.01);  // edges that do not lie on nodes are rounded
}

TEST(SampledMesh, ErrorNearASmoothSurfaceFallsWithTheSquareOfTheSpacing) {
  const Mesh ball = mesh_of(testing::sphere_mesh({0, 0, 0}, 1.0, 40));
  const Errors coarse = errors_of(ball, 10), fine = errors_of(ball, 20);
  EXPECT_LT(fine.largest_near_surface / 20, 0.4 * coarse.largest_near_surface / 10);
  EXPECT_LT(fine.largest_near_surface, 0.06);
}

TEST(SampledMesh, BeyondTheLatticeIsNoLessThanTheMeshesOwn) {
  const Mesh box = mesh_of(testing::box_mesh({0, 0, 0}, {1, 1, 1}));
  const SampledMesh sampled = sample_distances(box, 10);
  const Eigen::Vector3d far(5, 6.5, 0.5);
  EXPECT_GE(signed_distance(sampled, far), std::hypot(4.0, 5.5));
  EXPECT_LE(signed_distance(sampled, far), std::hypot(4.0, 5.5) + 2.0 * std::hypot(0.4, 0.4));
  EXPECT_NEAR(signed_distance(sampled, {0.5, 0.5, 5.0}), 4.0, 1e-9);
  const double at_the_last_node = 1.0 + 0.4 - 1e-12;
  EXPECT_NEAR(signed_distance(sampled, {0.5, 0.5, at_the_last_node}), 0.4, 1e-9);
  EXPECT_TRUE(bounds(sampled).isApprox(bounds(box)));
}

TEST(SampledMesh, KnowsHowThickItIs) {
  const SampledMesh plate = sample_distances(mesh_of(testing::box_mesh({0, 0, 0}, {1, 1, 0.2})), 40);
  EXPECT_NEAR(inradius({plate}), 0.1, plate.samples->spacing);
  EXPECT_LE(inradius({plate}), 0.1 + 1e-8);  // files are in single precision
}

testing::Triangles together(testing::Triangles a, const testing::Triangles& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

TEST(Mesh, ThinnestPartIsWhereSurfacesFaceEachOther) {
  const auto plate = testing::box_mesh({0, 0, 0}, {1, 1, 0.02});
  const auto block = testing::box_mesh({1.25, 0, 0}, {2, 1, 0.75});
  EXPECT_NEAR(thinnest_part(mesh_of(together(plate, block))), 0.02, 1e-6);
  EXPECT_NEAR(thinnest_part(mesh_of(block)), 0.75, 1e-6);
  const std::array corners{Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1)};
  const testing::Triangles tetrahedron{{corners[0], corners[2], corners[1]},
                                       {corners[0], corners[1], corners[3]},
                                       {corners[0], corners[3], corners[2]},
                                       {corners[1], corners[2], corners[3]}};
  EXPECT_EQ(thinnest_part(mesh_of(tetrahedron)), std::numeric_limits<double>::infinity());
  const SampledMesh sampled = sample_distances(mesh_of(tetrahedron));
  EXPECT_EQ(thinnest({sampled}), 2.0 * inradius({sampled}));
}

TEST(SampledMesh, PlateThinnerThanItsLatticeIsNotNothing) {
  const SampledMesh plate = sample_distances(mesh_of(testing::box_mesh({0, 0, 0}, {1, 1, 0.01})));
  EXPECT_NEAR(inradius({plate}), 0.005, 0.5 * plate.samples->spacing);
  EXPECT_NEAR(thinnest({plate}), 0.01, plate.samples->spacing);
  EXPECT_LT(signed_distance(plate, {0.503, 0.518, 0.005}), -0.002);
  const SampledMesh foil = sample_distances(mesh_of(testing::box_mesh({0, 0, 0}, {1, 1, 1e-6})));
  EXPECT_NEAR(thinnest({foil}), 1e-6, 1e-12);
  EXPECT_LT(foil.samples->distances.size(), 400'000);
}

TEST(Mesh, ShiftedIsTheSameElsewhere) {
  const Mesh box = mesh_of(testing::box_mesh({0, 0, 0}, {1, 1, 1}));
  const Mesh away = shifted(box, {10, 0, -3});
  EXPECT_NEAR(signed_distance(away, {10.5, 0.5, -2.75}), -0.25, 1e-12);
  EXPECT_NEAR(signed_distance(box, {0.5, 0.5, 0.25}), -0.25, 1e-12);
  EXPECT_EQ(triangles_of(away).size(), 12U);
}

}  // namespace
}  // namespace talus
