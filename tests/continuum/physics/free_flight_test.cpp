// Sand in the air: no pressure, no friction, an exact parabola (method.md, section 12).
#include <gtest/gtest.h>

#include "tests/continuum/scenes.h"

namespace talus {
namespace {

TEST(FreeFlight, IsAParabolaWithoutPressure) {
  Scene scene = testing::box_scene({20, 6, 40}, {3.0, 3.0, 3.0}, 0.01, 0.5);
  State state = initial_state(scene);
  state.particles.positions.colwise() += Eigen::Vector3d(0.02, 0.015, 0.05);
  const Eigen::Vector3d start_velocity(0.6, 0.0, 1.5);
  state.particles.velocities.colwise() = start_velocity;
  const Eigen::Matrix3Xd start = state.particles.positions;
  const double mass = state.particles.masses.sum();
  double highest_pressure = 0.0, euler_offset = 0.0;
  testing::run_for(state, StepSettings{}, 0.2, [&](const State& s, const StepReport& report) {
    highest_pressure = std::max(highest_pressure, s.warm->stress.pressure.maxCoeff());
    euler_offset += 0.5 * testing::gravity * report.dt * report.dt;  // forward Euler falls this much further
    EXPECT_EQ(report.particles_left, 0);
  });
  EXPECT_EQ(highest_pressure, 0.0);
  EXPECT_EQ(state.particles.masses.sum(), mass);
  Eigen::Vector3d moved = state.time * start_velocity;
  moved[2] -= 0.5 * testing::gravity * state.time * state.time + euler_offset;
  EXPECT_LT(((state.particles.positions - start).colwise() - moved).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT(
      (state.particles.velocities.colwise() - Eigen::Vector3d(0.6, 0.0, 1.5 - testing::gravity * state.time))
          .cwiseAbs()
          .maxCoeff(),
      1e-12);
}

TEST(FreeFlight, OutOfTheDomainIsCountedAndAnEmptyDomainStillSteps) {
  State state = initial_state(testing::box_scene({6, 6, 6}, {2.0, 2.0, 2.0}, 0.01, 0.5));
  const double mass = state.particles.masses.sum();
  const Eigen::Index count = state.particles.count();
  double mass_left = 0.0;
  Eigen::Index particles_left = 0;
  testing::run_for(state, StepSettings{}, 0.3, [&](const State&, const StepReport& report) {
    mass_left += report.mass_left;
    particles_left += report.particles_left;
  });
  EXPECT_EQ(state.particles.count(), 0);
  EXPECT_EQ(particles_left, count);
  EXPECT_NEAR(mass_left, mass, 1e-12 * mass);
  EXPECT_NEAR(state.time, 0.3, 1e-12);
}

}  // namespace
}  // namespace talus
