// The kernel: what the grid holds is exactly what the particles carry.
#include "continuum/particles/transfer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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
  const GridState grid = deposit(region, state.particles, state.materials,
                                 Eigen::ArrayXd::Constant(state.particles.count(), 0.5));
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
  const Field fill = deposit(region, state.particles, state.materials,
                             Eigen::ArrayXd::Constant(state.particles.count(), 0.5))
                         .fill;
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
  const GridState grid = deposit(region, state.particles, state.materials,
                                 Eigen::ArrayXd::Constant(state.particles.count(), 0.5));
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  Field after = grid.velocity;
  for (double& v : after) v += normal(random);
  after[region.null_face()] = 0.0;
  const Eigen::Matrix3Xd before = state.particles.velocities;
  update_velocities_flip(region, grid.velocity, after, 0.0, state.particles);
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

TEST(Transfer, GradientIsTheDerivativeOfTheInterpolation) {
  State state = disordered_state();
  state.grid.periodic[1] = true;
  Eigen::Matrix3Xd& positions = state.particles.positions;
  const ActiveRegion region = make_active_region(state.grid, state.sides, positions);
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  Field faces = Field::Zero(region.face_count());
  for (double& v : faces) v = normal(random);
  // Linear along each axis inside a half cell, so that a central difference there is exact but for round-off.
  const double h = state.grid.spacing, step = 1e-3 * h;
  for (double& x : positions.reshaped()) {
    const double half_cells = 2.0 * x / h, lower = std::floor(half_cells);
    x = 0.5 * h * (lower + std::clamp(half_cells - lower, 0.01, 0.99));
  }
  const Eigen::Matrix<double, 9, Eigen::Dynamic> gradients = interpolate_gradient(region, faces, positions);
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d offset = step * Eigen::Vector3d::Unit(axis);
    const Eigen::Matrix3Xd difference = (interpolate(region, faces, positions.colwise() + offset) -
                                         interpolate(region, faces, positions.colwise() - offset)) /
                                        (2.0 * step);
    EXPECT_GT(difference.norm(), 1.0);
    EXPECT_LT((gradients.middleRows(3 * axis, 3) - difference).cwiseAbs().maxCoeff(), 1e-11 / step) << axis;
  }
}

TEST(Transfer, GradientOfALinearVelocityIsItsMatrixAwayFromWallsAndSurface) {
  const State state = initial_state(testing::box_scene({6, 6, 6}, {6.0, 6.0, 6.0}, 0.1, 0.5));
  const ActiveRegion region = make_active_region(state.grid, state.sides, state.particles.positions);
  Eigen::Matrix3d matrix;
  matrix << 1.0, 2.0, -3.0, 0.5, -1.5, 0.7, 4.0, -2.0, 0.5;
  Field faces = Field::Zero(region.face_count());
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3i extent = state.grid.extent(Grid::nodal_of_face(axis));
    for (int k = 0; k < extent[2]; ++k)
      for (int j = 0; j < extent[1]; ++j)
        for (int i = 0; i < extent[0]; ++i) {
          const Eigen::Vector3i at(i, j, k);
          const int face = region.face_of_dense[static_cast<std::size_t>(axis)]
                                               [static_cast<std::size_t>(state.grid.face_index(axis, at))];
          Eigen::Vector3d place = at.cast<double>() + Eigen::Vector3d::Constant(0.5);
          place[axis] -= 0.5;
          if (face >= 0) faces[face] = matrix.row(axis).dot(0.1 * place);
        }
  }
  Eigen::Matrix3Xd inner(3, 2);
  inner.col(0) = Eigen::Vector3d(0.27, 0.31, 0.22);
  inner.col(1) = Eigen::Vector3d(0.33, 0.2, 0.35);
  const auto gradients = interpolate_gradient(region, faces, inner);
  for (Eigen::Index p = 0; p < 2; ++p) EXPECT_LT((gradients.col(p) - matrix.reshaped()).norm(), 1e-12);
}

/// A full domain, and a cloud whose kernels reach neither the domain's sides nor a cell without sand.
struct Interior {
  Interior() {
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    cloud.resize(60);
    for (double& x : cloud.positions.reshaped()) x = 0.15 + 0.5 * unit(random);
    for (double& v : cloud.velocities.reshaped()) v = normal(random);
    for (double& m : cloud.masses) m = 0.5 + unit(random);
  }
  GridState grid() const {
    return deposit(region, cloud, state.materials, Eigen::ArrayXd::Constant(cloud.count(), 0.5));
  }
  /// Of the faces' momenta about the origin, kg m^2/s.
  Eigen::Vector3d angular_momentum(const GridState& grid) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3i n = state.grid.extent(Grid::nodal_of_face(axis));
      for (int dense = 0; dense < n.prod(); ++dense) {
        const int face =
            region.face_of_dense[static_cast<std::size_t>(axis)][static_cast<std::size_t>(dense)];
        Eigen::Vector3d place(dense % n[0], dense / n[0] % n[1], dense / (n[0] * n[1]));
        place = 0.1 * (place + 0.5 * (Eigen::Vector3d::Ones() - Eigen::Vector3d::Unit(axis)));
        sum += place.cross(grid.face_mass[face] * grid.velocity[face] * Eigen::Vector3d::Unit(axis));
      }
    }
    return sum;
  }
  State state = initial_state(testing::box_scene({8, 8, 8}, {8.0, 8.0, 8.0}, 0.1, 0.5));
  ActiveRegion region = make_active_region(state.grid, state.sides, state.particles.positions);
  Particles cloud;
};

TEST(Apic, RoundTripConservesMomentumAndAngularMomentum) {
  Interior interior;
  Particles& cloud = interior.cloud;
  const Eigen::Vector3d momentum = cloud.velocities * cloud.masses.matrix();
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();
  for (Eigen::Index p = 0; p < cloud.count(); ++p)
    angular += cloud.masses[p] *
               Eigen::Vector3d(cloud.positions.col(p)).cross(Eigen::Vector3d(cloud.velocities.col(p)));
  EXPECT_GT(angular.norm(), 0.1);
  for (int trip = 0; trip < 3; ++trip) {
    const GridState grid = interior.grid();
    EXPECT_LT((interior.angular_momentum(grid) - angular).norm(), 1e-12) << trip;
    update_velocities_apic(interior.region, grid.velocity, cloud);
    EXPECT_LT((cloud.velocities * cloud.masses.matrix() - momentum).norm(), 1e-12) << trip;
  }
  EXPECT_GT(cloud.gradients.norm(), 1.0);  // what carries the angular momentum on
}

TEST(Apic, AFlowWithAConstantGradientPassesUnchanged) {
  Interior interior;
  Eigen::Matrix3d matrix;
  matrix << 1.0, 2.0, -3.0, 0.5, -1.5, 0.7, 4.0, -2.0, 0.5;
  // The whole domain's sand, so that every face has the flow's velocity.
  Particles& sand = interior.state.particles;
  sand.velocities = matrix * sand.positions;
  sand.gradients = matrix.reshaped().replicate(1, sand.count());
  const GridState grid =
      deposit(interior.region, sand, interior.state.materials, Eigen::ArrayXd::Constant(sand.count(), 0.5));
  update_velocities_apic(interior.region, grid.velocity, interior.cloud);
  EXPECT_LT((interior.cloud.velocities - matrix * interior.cloud.positions).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((interior.cloud.gradients.colwise() - matrix.reshaped()).cwiseAbs().maxCoeff(), 1e-11);
}

double kinetic_energy(const Particles& particles) {
  return 0.5 * (particles.masses * particles.velocities.colwise().squaredNorm().transpose().array()).sum();
}

TEST(Flip, WithoutPicNoEnergyIsLost) {
  Interior interior;
  Particles& cloud = interior.cloud;
  // Nothing happens on the grid: any motion stays as it is.
  GridState grid = interior.grid();
  const Eigen::Matrix3Xd before = cloud.velocities;
  update_velocities_flip(interior.region, grid.velocity, grid.velocity, 0.0, cloud);
  EXPECT_EQ(cloud.velocities, before);
  // A uniform push changes a uniform flow's energy by that of its speed alone.
  cloud.velocities.colwise() = Eigen::Vector3d(1.0, -2.0, 0.5);
  grid = interior.grid();
  update_velocities_flip(interior.region, grid.velocity, 3.0 * grid.velocity, 0.0, cloud);
  const double start = 0.5 * cloud.masses.sum() * 5.25;
  EXPECT_NEAR(kinetic_energy(cloud), 9.0 * start, 1e-11 * start);
  // With PIC, disorder is lost, and momentum is not.
  cloud.velocities = before;
  grid = interior.grid();
  const double disordered = kinetic_energy(cloud);
  update_velocities_flip(interior.region, grid.velocity, grid.velocity, 0.5, cloud);
  EXPECT_LT(kinetic_energy(cloud), 0.9 * disordered);
  EXPECT_LT(((cloud.velocities - before) * cloud.masses.matrix()).norm(), 1e-12);
}

TEST(Transfer, BesideSolidsWeightsSumToOneUnlessTheOwnCellIsClosedOnBothSides) {
  State state = disordered_state();
  // A slope, and a block across the corner, with pockets that they close.
  state.openings = make_openings(state.grid, [](const Eigen::Vector3d& x) {
    const double slope = Eigen::Vector3d(0.3, 0.5, 1.0).normalized().dot(x) - 0.22;
    const double block = (x - Eigen::Vector3d(0.35, 0.2, 0.25)).cwiseAbs().maxCoeff() - 0.12;
    return WallDistance{std::min(slope, block), 0.4};
  });
  const Eigen::Matrix3Xd& positions = state.particles.positions;
  const ActiveRegion region = make_active_region(state.grid, state.sides, positions, state.openings);
  Field ones = Field::Ones(region.face_count());
  ones[region.null_face()] = 0.0;
  const Eigen::Matrix3Xd sums = interpolate(region, ones, positions);
  int whole = 0, closed = 0;
  for (Eigen::Index p = 0; p < positions.cols(); ++p) {
    const Eigen::Vector3i cell = state.grid.cell_at(positions.col(p));
    for (int axis = 0; axis < 3; ++axis) {
      const auto share = [&](int side) {
        return state.openings.face_share(
            axis, state.grid.face_index(axis, cell + side * Eigen::Vector3i::Unit(axis)));
      };
      if (share(0) > 0.0 || share(1) > 0.0) {
        EXPECT_NEAR(sums(axis, p), 1.0, 1e-13) << positions.col(p).transpose();
        ++whole;
      } else {
        EXPECT_LE(sums(axis, p), 1.0 + 1e-13);
        ++closed;
      }
    }
  }
  EXPECT_GT(whole, 200);
  EXPECT_GT(closed, 10);
  // No volume is lost either.
  const GridState grid = deposit(region, state.particles, state.materials,
                                 Eigen::ArrayXd::Constant(state.particles.count(), 0.5));
  const double volume = minimum_volumes(state.particles, state.materials).sum();
  EXPECT_NEAR((grid.fill * region.cell_kernel).sum() * state.grid.cell_volume(), volume, 1e-12 * volume);
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
