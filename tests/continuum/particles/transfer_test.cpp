// The kernel: what the grid holds is exactly what the particles carry.
#include "continuum/particles/transfer.h"

#include <gtest/gtest.h>

#include <random>

#include "continuum/particles/move.h"
#include "tests/continuum/scenes.h"

namespace talus {
namespace {

State disordered_state() {
  Scene scene = testing::box_scene({8, 6, 7}, {5.0, 4.0, 3.3}, 0.1, 0.5);
  scene.sides[2][0] = {true, 0.5};
  scene.sides[0][0] = {true, 0.0};
  scene.jitter = 0.9;
  State state = initial_state(scene);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (double& v : state.particles.velocities.reshaped()) v = normal(random);
  return state;
}

TEST(Transfer, GridHoldsMassMomentumAndVolumeOfTheParticles) {
  const State state = disordered_state();
  const ActiveRegion region = make_active_region(state.grid, state.sides, state.particles.positions);
  const GridState grid = deposit(region, state.particles, state.materials);
  const double mass = state.particles.masses.sum();
  const double volume = mass / state.materials[0].max_density();
  EXPECT_NEAR(grid.fill.sum() * state.grid.cell_volume(), volume, 1e-12 * volume);
  EXPECT_NEAR(grid.face_mass.sum(), 3.0 * mass, 1e-12 * mass);
  EXPECT_NEAR(grid.face_volume.sum(), 3.0 * volume, 1e-12 * volume);
  const double momentum =
      (state.particles.velocities.array().rowwise() * state.particles.masses.transpose()).sum();
  EXPECT_NEAR((grid.face_mass * grid.velocity).sum(), momentum, 1e-12 * mass);
  EXPECT_EQ(grid.face_mass[region.null_face()], 0.0);
}

TEST(Transfer, FullLatticeGivesFillOneEverywhereEvenBesideWallsAndAtTheSurface) {
  Scene scene = testing::box_scene({6, 1, 6}, {6.0, 1.0, 3.0}, 0.1, 0.5);
  scene.grid.periodic[1] = true;
  scene.sides[0] = {Side{true, 0.0}, Side{true, 0.0}};
  scene.sides[2][0] = {true, 0.5};
  const State state = initial_state(scene);
  const ActiveRegion region = make_active_region(state.grid, state.sides, state.particles.positions);
  const Field fill = deposit(region, state.particles, state.materials).fill;
  const Field seen = deposit_fill(region, state.particles, state.materials);
  EXPECT_EQ(region.cell_count(), 18);
  for (int cell = 0; cell < region.cell_count(); ++cell) {
    EXPECT_NEAR(fill[cell], 1.0, 1e-12);
    // The density correction sees the surface row only as far as the kernel does: 7/8.
    const bool surface =
        region.grid.cell_of_index(region.dense_of_cell[static_cast<std::size_t>(cell)])[2] == 2;
    EXPECT_NEAR(seen[cell], surface ? 0.875 : 1.0, 1e-12);
  }
}

TEST(Transfer, WhatFacesGainTheParticlesGain) {
  State state = disordered_state();
  const ActiveRegion region = make_active_region(state.grid, state.sides, state.particles.positions);
  const GridState grid = deposit(region, state.particles, state.materials);
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  Field after = grid.velocity;
  for (double& v : after) v += normal(random);
  after[region.null_face()] = 0.0;
  const Eigen::Matrix3Xd before = state.particles.velocities;
  update_velocities(region, grid.velocity, after, 0.0, state.particles);
  const double gained =
      ((state.particles.velocities - before).array().rowwise() * state.particles.masses.transpose()).sum();
  EXPECT_NEAR(gained, (grid.face_mass * (after - grid.velocity)).sum(), 1e-12 * grid.face_mass.sum());
  EXPECT_GT(std::abs(gained), 1e-6);
}

TEST(Transfer, InterpolationReproducesAUniformField) {
  const State state = disordered_state();
  const ActiveRegion region = make_active_region(state.grid, state.sides, state.particles.positions);
  const Field uniform = Field::Constant(region.face_count(), 2.5);
  const Eigen::Matrix3Xd values = interpolate(region, uniform, state.particles.positions);
  EXPECT_LT((values.array() - 2.5).abs().maxCoeff(), 1e-13);
}

TEST(Move, ParticlesThatLeaveAreCountedAndTheRestKept) {
  State state = disordered_state();
  const Eigen::Index n = state.particles.count();
  const double mass = state.particles.masses.sum();
  state.particles.positions(0, 4) = 99.0;
  state.particles.positions(2, 7) = -1.0;
  const Eigen::Vector3d next = state.particles.positions.col(5);
  const Departed departed = remove_departed(state.grid, state.particles);
  EXPECT_EQ(departed.count, 2);
  EXPECT_EQ(state.particles.count(), n - 2);
  EXPECT_NEAR(departed.mass + state.particles.masses.sum(), mass, 1e-12 * mass);
  EXPECT_EQ(state.particles.positions.col(4), next);
}

}  // namespace
}  // namespace talus
