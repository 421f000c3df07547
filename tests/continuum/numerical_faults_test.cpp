// What is not finite, or does not get on, stops a step with a clear word about what, where and when.
#include "continuum/numerical_faults.h"

#include <gmock/gmock.h>

#include "continuum/step.h"
#include "tests/continuum/scenes.h"

namespace talus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double h = 0.01;  // m
const double none = std::nan("");

/// A box of sand that has been moving for three steps.
State moving() {
  Scene scene = testing::box_scene({8, 4, 8}, {4.0, 4.0, 4.0}, h, 0.5);
  scene.sides[2][0] = {true, 0.5};
  scene.bodies = {make_body("ball", Shape{Sphere{{0.06, 0.02, 0.05}, 0.01}}, 2000.0)};
  State state = initial_state(scene);
  for (int i = 0; i < 3; ++i) step(state, StepSettings{}, 1e-3);
  return state;
}

std::string error_of_step(State& state, const StepSettings& settings = {}) {
  try {
    step(state, settings, 1e-3);
  } catch (const NumericalError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Faults, WhateverOfAParticleIsNotSoundIsTold) {
  const auto error_after = [](const auto& spoil) {
    State state = moving();
    spoil(state.particles);
    return error_of_step(state);
  };
  EXPECT_THAT(error_after([](Particles& p) { p.velocities(1, 7) = none; }),
              AllOf(HasSubstr("the velocity of particle 7 is not finite"), HasSubstr("at t = 0.003 s"),
                    HasSubstr(") m")));
  EXPECT_THAT(error_after([](Particles& p) { p.velocities(1, 7) = HUGE_VAL; }), HasSubstr("the velocity"));
  EXPECT_THAT(error_after([](Particles& p) { p.positions(0, 3) = none; }),
              HasSubstr("the position of particle 3 is not one in the domain"));
  EXPECT_THAT(error_after([](Particles& p) { p.positions(2, 3) = -1.0; }),
              HasSubstr("the position of particle 3"));
  EXPECT_THAT(error_after([](Particles& p) { p.masses[0] = 0.0; }), HasSubstr("the mass of particle 0"));
  EXPECT_THAT(error_after([](Particles& p) { p.masses[0] = none; }), HasSubstr("the mass of particle 0"));
  EXPECT_THAT(error_after([](Particles& p) { p.shapes(5, 9) = none; }), HasSubstr("the shape of particle 9"));
}

TEST(Faults, SoIsWhateverOfABody) {
  State state = moving();
  state.bodies[0].twist.angular_velocity[0] = none;
  EXPECT_THAT(error_of_step(state), HasSubstr("the velocity of body 'ball' is not finite"));
  state = moving();
  state.bodies[0].pose.position[1] = HUGE_VAL;
  EXPECT_THAT(error_of_step(state), HasSubstr("the pose of body 'ball' is not finite"));
}

TEST(Faults, SoIsTheStressThatTheLastStepLeft) {
  State state = moving();
  std::get<Stress>(state.warm->stress).pressure[0] = none;
  EXPECT_THAT(error_of_step(state), AllOf(HasSubstr("the pressure that the last step left is not finite"),
                                          HasSubstr("in the cell about (0.0")));
  state = moving();
  std::get<Stress>(state.warm->stress).copies[2] = HUGE_VAL;
  EXPECT_THAT(error_of_step(state),
              AllOf(HasSubstr("the friction stress that the last step left is not finite"),
                    HasSubstr("in the cell about (0.0")));
}

TEST(Faults, AVelocityThatIsNotFiniteIsToldWithItsFace) {
  const State state = moving();
  const ActiveRegion& region = state.warm->region;
  const auto error_with = [&](int face) {
    Field velocity = Field::Zero(region.face_count());
    velocity[face] = none;
    try {
      require_finite(region, velocity, 0.25, 1e-3);
    } catch (const NumericalError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(error_with(0), AllOf(HasSubstr("the sand's velocity along x is not finite at t = 0.25 s"),
                                   HasSubstr("dt = 0.001 s, on the face about (0, 0.005, 0.005) m")));
  EXPECT_THAT(error_with(region.face_count() - 1),
              AllOf(HasSubstr("the sand's velocity along z"), HasSubstr(", 0) m")));
}

TEST(Faults, APositionThatIsNotFiniteIsToldWithWhatMovedIt) {
  State state = moving();
  require_finite_positions(state.particles, "the step", 0.25);
  state.particles.positions(1, 4) = none;
  try {
    require_finite_positions(state.particles, "the step", 0.25);
    FAIL();
  } catch (const NumericalError& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("the position of particle 4 is not finite after the step at t = 0.25 s, mass "));
  }
}

TEST(Faults, NothingHasChangedAfterAnUnsoundStateIsRefused) {
  State state = moving();
  state.particles.velocities(0, 0) = none;
  const State before = state;
  error_of_step(state);
  EXPECT_EQ(state.time, before.time);
  EXPECT_EQ(state.particles.positions, before.particles.positions);
  EXPECT_EQ(state.bodies[0].pose.position, before.bodies[0].pose.position);
}

/// Solves that may do nothing leave the sand in free fall through its floor: off by g dt and more.
TEST(Faults, SolvesThatStagnateAreTriedWithShorterStepsAndThenStopped) {
  State state = moving();
  StepSettings settings;
  settings.projection.max_friction_iterations = settings.projection.max_pressure_iterations = 1;
  state.warm.reset();
  state.particles.velocities.row(2).setConstant(-1.0);
  EXPECT_THAT(error_of_step(state, settings),
              AllOf(HasSubstr("have stagnated"), HasSubstr("4 shorter time steps")));
}

TEST(Faults, AStepThatConvergesHasNoStagnation) {
  State state = moving();
  EXPECT_EQ(step(state, StepSettings{}, 1e-3).stagnations, 0);
}

}  // namespace
}  // namespace talus
