// Scenes that the harness writes: the solver's own reader takes each of them, and finds in it what the case says.
#include "validation/backends/continuum_scene.h"

#include <gmock/gmock.h>

#include <cmath>

#include "continuum/files/atomic_file.h"
#include "continuum/scene/scene.h"
#include "dem_cases/falling_sphere.h"
#include "dem_cases/reference/plan.h"
#include "tests/test_folder.h"

namespace talus::validation {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path cases = std::filesystem::path(TALUS_SOURCE_DIR) / "dem_cases";

dem::MaterialConstants material() {
  dem::MaterialConstants m{};
  m.friction_angle = 0.5;
  m.max_volume_fraction = 0.57;
  m.friction_law = dem::FrictionLaw{.mu_1 = 0.4,
                                    .mu_1_uncertainty = 0.01,
                                    .mu_2 = 0.7,
                                    .mu_2_uncertainty = 0.01,
                                    .I_0 = 0.2,
                                    .I_0_uncertainty = 0.01};
  return m;
}

Scene scene_of(const dem::Case& a_case, int cells, const dem::MaterialConstants& constants = material(),
               const Defects& defects = {}) {
  const testing::TestFolder folder;
  write_file_atomically(folder.path() / "scene.toml",
                        continuum_scene(a_case, constants, {cells, 2, 0.5}, 7, defects));
  return read_scene(folder.path() / "scene.toml");
}

double sand_volume(const Scene& scene) {
  const State state = initial_state(scene);
  return state.particles.masses.sum() / scene.materials[0].max_density();
}

TEST(ContinuumScene, EveryCaseThatItCanRunHoldsItsFillAndItsPhysics) {
  const std::map<std::string, int> cells{{"column_collapse", 20},
                                         {"cylinder_collapse", 8},
                                         {"slot", 12},
                                         {"hourglass", 8},
                                         {"ledge", 32},
                                         {"heap", 8},
                                         {"impact", 6}};
  int seen = 0;
  for (const auto& file : dem::gravity_case_files()) {
    for (const auto& a_case : dem::read_case_points(file)) {
      ++seen;
      const Scene scene = scene_of(a_case, cells.at(a_case.kind));
      const double thickness = dem::periodic_thickness(a_case.geometry);
      const double share = thickness > 0.0 ? scene.grid.spacing / thickness : 1.0;
      // Nominal volumes of hourglasses are of their tubes and cones; curved ones are met to what a lattice can.
      EXPECT_NEAR(sand_volume(scene) / (share * dem::fill_volume(a_case.geometry)), 1.0,
                  thickness > 0.0 ? 0.02 : 0.05)
          << a_case.name << "/" << a_case.point;
      EXPECT_NEAR(scene.gravity.z(), -9.81, 1e-12);
      EXPECT_EQ(scene.grid.periodic[1], thickness > 0.0);
      EXPECT_EQ(scene.seed, 7u);
      EXPECT_NEAR(scene.end_time, a_case.protocol.run_time, 1e-12);
      EXPECT_NEAR(scene.materials[0].friction, 0.4, 1e-12);
      EXPECT_NEAR(scene.materials[0].rate.fast_friction, 0.7, 1e-12);
      EXPECT_NEAR(scene.materials[0].rate.inertial_number, 0.2, 1e-12);
      EXPECT_NEAR(scene.materials[0].rate.grain_diameter, a_case.grains.diameter, 1e-12);
    }
  }
  EXPECT_EQ(seen, 32);
}

TEST(ContinuumScene, WithoutAFrictionLawMuIsTheSineOfTheCriticalAngle) {
  dem::MaterialConstants m = material();
  m.friction_law.reset();
  const Scene scene = scene_of(dem::read_case(cases / "column_collapse/case.toml"), 20, m);
  EXPECT_NEAR(scene.materials[0].friction, std::sin(0.5), 1e-12);
  EXPECT_EQ(scene.materials[0].rate.inertial_number, 0.0);
}

TEST(ContinuumScene, AHourglassHasItsThroatAndTheFrictionOfItsGlass) {
  const auto a_case = dem::read_case(cases / "hourglass/cone.toml");
  const Scene scene = scene_of(a_case, 8);
  ASSERT_EQ(scene.walls.size(), 1u);
  EXPECT_NEAR(scene.walls[0].friction, a_case.contact.wall_friction, 1e-12);
  const auto distance = [&](double r, double z) {
    return nearest_wall(scene.walls, 0.0, {r, 0.0, z}).distance;
  };
  EXPECT_GT(distance(0.0119, 0.0), 0.0);
  EXPECT_LT(distance(0.0121, 0.0), 0.0);
  EXPECT_GT(distance(0.0295, 0.05), 0.0);
  EXPECT_LT(distance(0.0305, -0.05), 0.0);
  EXPECT_LT(distance(0.0, -0.121), 0.0);
}

TEST(ContinuumScene, AnImpactHasTheSameSphereAsTheDiscreteCodes) {
  const auto a_case = dem::read_case(cases / "impact/case.toml", "speed_2");
  const Scene scene = scene_of(a_case, 6);
  ASSERT_EQ(scene.bodies.size(), 1u);
  const Body& ball = scene.bodies[0];
  const auto sphere = dem::falling_sphere(a_case);
  EXPECT_NEAR((ball.pose.position - sphere->centre).norm(), 0.0, 1e-12);
  EXPECT_NEAR(ball.twist.velocity.z(), -sphere->speed, 1e-12);
  EXPECT_NEAR(ball.mass, 7800.0 * M_PI / 6.0 * std::pow(0.0254, 3), 1e-6);
  EXPECT_NEAR(ball.friction, a_case.contact.friction, 1e-12);
  EXPECT_NEAR(scene.grid.spacing, 0.0254 / 6.0, 1e-12);
  for (const int axis : {0, 1}) EXPECT_EQ(scene.sides[axis][0].friction, 0.0);
  EXPECT_EQ(scene.sides[2][0].friction, as_rough_as_sand);
}

TEST(ContinuumScene, AHeapHasATubeThatRises) {
  const auto a_case = dem::read_case(cases / "pile_angle/heap.toml");
  const Scene scene = scene_of(a_case, 8);
  ASSERT_EQ(scene.bodies.size(), 1u);
  const Body& tube = scene.bodies[0];
  const double h = scene.grid.spacing;
  EXPECT_NEAR(signed_distance(tube, {0.0, 0.0, 0.03}), 0.024, 1e-9);
  EXPECT_NEAR(signed_distance(tube, {0.024 + h, 0.0, 0.03}), -h, 1e-9);
  EXPECT_NEAR(std::get<Prescribed>(tube.motion).twist.velocity.z(), 0.05, 1e-12);
  EXPECT_NEAR(tube.friction, a_case.contact.wall_friction, 1e-12);
  // It clears the fill, and stays in the domain.
  const double top = bounds(tube).max().z();
  EXPECT_GE(top, 0.072);
  EXPECT_LE(top + 0.05 * a_case.protocol.run_time, scene.grid.spacing * scene.grid.cells.z());
}

TEST(ContinuumScene, ASlotIsOpenWhereItsEdgesSayAndRoughElsewhere) {
  const auto a_case = dem::read_case(cases / "hourglass/case.toml");
  const Scene scene = scene_of(a_case, 12);
  const auto distance = [&](double x, double z) {
    return nearest_wall(scene.walls, 0.0, {x, 0.0, z}).distance;
  };
  EXPECT_GT(distance(0.045, -0.001), 0.0);
  EXPECT_GT(distance(0.0335, -0.0005), 0.0);
  EXPECT_LT(distance(0.0325, -0.0005), 0.0);
  EXPECT_LT(distance(0.0575, -0.0005), 0.0);
  for (const auto& wall : scene.walls) EXPECT_EQ(wall.friction, as_rough_as_sand);
}

// A file's name stands in a comment of the scene, and must not get out of it.
TEST(ContinuumScene, ACaseFilesNameAddsNothingToTheScene) {
  dem::Case a_case = dem::read_case(cases / "column_collapse/case.toml");
  a_case.file = "case\n[solver]\nbroken = \"pressure_pulls\"\n.toml";
  EXPECT_EQ(scene_of(a_case, 8).broken, "");
}

TEST(ContinuumScene, DefectsAreWhatTheySay) {
  const auto a_case = dem::read_case(cases / "hourglass/cone.toml");
  const Scene soft = scene_of(a_case, 8, material(), {.friction_factor = 0.5, .gravity_factor = 0.9});
  EXPECT_NEAR(soft.materials[0].friction, 0.2, 1e-12);
  EXPECT_NEAR(soft.materials[0].rate.fast_friction, 0.35, 1e-12);
  EXPECT_NEAR(soft.gravity.z(), -0.9 * 9.81, 1e-12);
  EXPECT_NEAR(soft.walls[0].friction, a_case.contact.wall_friction, 1e-12);
  const Scene smooth = scene_of(a_case, 8, material(), {.walls_have_friction = false});
  EXPECT_EQ(smooth.walls[0].friction, 0.0);
  const Scene column = scene_of(dem::read_case(cases / "column_collapse/case.toml"), 20, material(),
                                {.walls_have_friction = false});
  EXPECT_EQ(column.sides[2][0].friction, 0.0);
}

TEST(ContinuumScene, WhatItCannotRunIsRefused) {
  auto column = dem::read_case(cases / "column_collapse/case.toml");
  dem::column_geometry(column).rough_floor = false;
  EXPECT_THAT(testing::input_error([&] {
                continuum_scene(column, material(), {20, 2, 0.5}, 1);
              }),
              HasSubstr("rough floor only"));
}

}  // namespace
}  // namespace talus::validation
