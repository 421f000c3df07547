// Layers on a floor (method.md, section 12): sliding, and at rest.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/continuum/scenes.h"

namespace talus {
namespace {

using testing::gravity;

constexpr double spacing = 0.01;  // m

/// A layer on a floor, endless along x and y: `cells_deep` cells of sand.
Scene layer(double cells_deep, double friction) {
  const int columns = 6;
  Scene scene = testing::box_scene({columns, 1, 12}, {columns, 1.0, cells_deep}, spacing, friction);
  scene.grid.periodic = {true, true, false};
  scene.sides[2][0] = {true, friction};
  scene.particles_per_cell.setConstant(cells_deep < 1.0 ? 8 : 2);
  return scene;
}

struct Sliding {
  double cells_deep;
  double allowed;  // relative error of the deceleration
};

void PrintTo(const Sliding& sliding, std::ostream* out) { *out << sliding.cells_deep << " cells"; }

class SlidingLayer : public ::testing::TestWithParam<Sliding> {};

TEST_P(SlidingLayer, DeceleratesAtMuG) {
  const double mu = 0.4;
  State state = initial_state(layer(GetParam().cells_deep, mu));
  state.particles.velocities.row(0).setConstant(1.0);
  const StepSettings settings = testing::step_settings();
  // Let the contact settle, then measure over several steps.
  testing::run_for(state, settings, 0.02, [](const State&, const StepReport&) {});
  const double v0 = testing::mean_velocity(state, 0), t0 = state.time;
  int cap_hits = 0;
  testing::run_for(state, settings, 0.1,
                   [&](const State&, const StepReport& r) { cap_hits += r.projection.cap_hits; });
  const double deceleration = (v0 - testing::mean_velocity(state, 0)) / (state.time - t0);
  EXPECT_NEAR(deceleration / (mu * gravity), 1.0, GetParam().allowed);
  EXPECT_EQ(cap_hits, 0);
  fmt::print("[ measured ] layer of {} cells: deceleration over mu g {:.4f}\n", GetParam().cells_deep,
             deceleration / (mu * gravity));
}

INSTANTIATE_TEST_SUITE_P(Section12, SlidingLayer,
                         ::testing::Values(Sliding{0.25, 0.15}, Sliding{1.0, 0.03}, Sliding{4.0, 0.03}),
                         [](const auto& instance) {
                           return "cells_x100_" + std::to_string(int(100 * instance.param.cells_deep));
                         });

TEST(SlidingLayerIn3D, DeceleratesTheSameInEveryDirectionOfTheGrid) {
  // Fully 3-D, jittered, sheared through its depth: against the grid's axes, and turned about the vertical.
  const double mu = 0.4;
  std::vector<double> decelerations;
  for (const double direction_deg : {0.0, 30.0, 45.0}) {
    const double angle = direction_deg * std::numbers::pi / 180.0;
    Scene scene = testing::box_scene({6, 6, 7}, {6.0, 6.0, 4.0}, spacing, mu);
    scene.grid.periodic = {true, true, false};
    scene.sides[2][0] = {true, mu};
    scene.jitter = 0.5;
    State state = initial_state(scene);
    const Eigen::Vector3d along(std::cos(angle), std::sin(angle), 0.0);
    state.particles.velocities.colwise() = along;
    testing::run_for(state, testing::step_settings(), 0.02, [](const State&, const StepReport&) {});
    const auto speed = [&] {
      return along[0] * testing::mean_velocity(state, 0) + along[1] * testing::mean_velocity(state, 1);
    };
    const double v0 = speed(), t0 = state.time;
    testing::run_for(state, testing::step_settings(), 0.1, [](const State&, const StepReport&) {});
    decelerations.push_back((v0 - speed()) / (state.time - t0) / (mu * gravity));
    const double sideways =
        -along[1] * testing::mean_velocity(state, 0) + along[0] * testing::mean_velocity(state, 1);
    fmt::print(
        "[ measured ] 3-D layer sliding at {} deg to the grid: deceleration over mu g {:.4f}, sideways "
        "{:.5f} m/s\n",
        direction_deg, decelerations.back(), sideways);
    EXPECT_NEAR(decelerations.back(), 1.0, 0.03);
    EXPECT_LT(std::abs(sideways), 0.01);
  }
}

TEST(LayerAtRest, PressureIsHydrostaticAndNothingMoves) {
  const double depth = 8.0;
  State state = initial_state(layer(depth, 0.4));
  StepSettings settings = testing::step_settings();
  settings.projection.tolerance = 1e-6;
  testing::tag(state);
  const Eigen::Matrix3Xd start = testing::positions_by_tag(state);
  testing::run_for(state, settings, 0.1, [](const State&, const StepReport&) {});
  const auto& [region, stress, shear_rate, confining, dt, by_sand] = *state.warm;
  const double density = state.materials[0].max_density(), area = spacing * spacing;
  for (int cell = 0; cell < region.cell_count(); ++cell) {
    const int k = region.grid.cell_of_index(region.dense_of_cell[static_cast<std::size_t>(cell)])[2];
    const double expected = density * gravity * spacing * (depth - k - 0.5);
    EXPECT_NEAR(pressure_of(stress)[cell] / (dt * area), expected,
                1e-4 * density * gravity * spacing * depth);
  }
  EXPECT_LT((testing::positions_by_tag(state) - start).cwiseAbs().maxCoeff(), 1e-4 * spacing);
}

TEST(LayerAtRest, HoldsOnSlopesWhereEveryCopyIsExactlyAtYieldOrAtZero) {
  // Perfect lattices once drove the friction solver's step length to infinity.
  for (const double angle_deg : {0.0, 2.0, 10.0, 21.8}) {
    const double angle = angle_deg * std::numbers::pi / 180.0;
    State state = initial_state(layer(4.0, 0.4));
    state.gravity = gravity * Eigen::Vector3d(std::sin(angle), 0.0, -std::cos(angle));
    testing::run_for(state, testing::step_settings(), 0.3, [](const State&, const StepReport&) {});
    EXPECT_LT(std::abs(testing::mean_velocity(state, 0)), 0.02 * gravity * 0.3) << angle_deg;
    EXPECT_LT(state.friction_solver.lipschitz(), 1e3) << angle_deg;
  }
}

TEST(LayerAtRest, SqueezedSandIsMovedApartByTheDensityCorrection) {
  State state = initial_state(layer(8.0, 0.4));
  state.particles.positions.row(2) *= 0.85;
  const auto height = [&] { return 2.0 * state.particles.positions.row(2).mean() / (8.0 * spacing); };
  EXPECT_NEAR(height(), 0.85, 1e-12);
  testing::run_for(state, testing::step_settings(), 0.3, [](const State&, const StepReport&) {});
  EXPECT_GT(height(), 0.97);
  EXPECT_LT(height(), 1.03);
}

TEST(LayerAtRest, ThrownUpItLeavesTheFloorFreely) {
  State state = initial_state(layer(3.0, 0.4));
  state.particles.velocities.row(2).setConstant(0.5);
  testing::run_for(state, testing::step_settings(), 0.02, [](const State&, const StepReport&) {});
  const double expected = 0.5 - gravity * 0.02;
  EXPECT_NEAR(state.particles.velocities.row(2).minCoeff(), expected, 0.02);
  EXPECT_NEAR(state.particles.velocities.row(2).maxCoeff(), expected, 0.02);
}

TEST(Numerics, AVelocityThatIsNotFiniteStopsTheStepWithItsTime) {
  State state = initial_state(layer(2.0, 0.4));
  state.particles.velocities(0, 5) = std::nan("");
  EXPECT_THROW(step(state, testing::step_settings(), 0.001), NumericalError);
}

TEST(LayerAtRest, TiltedGravityBelowTheFrictionAngleHoldsAndAboveSlides) {
  for (const double excess_deg : {-4.0, 4.0}) {
    const double angle = (21.8 + excess_deg) * std::numbers::pi / 180.0;  // atan(0.4) = 21.8 deg
    State state = initial_state(layer(4.0, 0.4));
    state.gravity = gravity * Eigen::Vector3d(std::sin(angle), 0.0, -std::cos(angle));
    testing::run_for(state, testing::step_settings(), 0.3, [](const State&, const StepReport&) {});
    const double sliding = gravity * (std::sin(angle) - 0.4 * std::cos(angle)) * 0.3;
    if (excess_deg < 0.0)
      EXPECT_NEAR(testing::mean_velocity(state, 0), 0.0, 0.01 * gravity * 0.3);
    else
      EXPECT_NEAR(testing::mean_velocity(state, 0) / sliding, 1.0, 0.1);
  }
}

}  // namespace
}  // namespace talus
