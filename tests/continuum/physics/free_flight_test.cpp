// Sand in the air: no pressure, no friction, an exact parabola (method.md, section 12).
#include <gtest/gtest.h>

#include "tests/continuum/scenes.h"

namespace talus {
namespace {

TEST(FreeFlight, OfASphereIsAParabolaWithoutPressure) {
  Scene scene = testing::box_scene({22, 8, 42}, {1.0, 1.0, 1.0}, 0.01, 0.5);
  scene.fillings = {{0, Shape{Sphere{{0.04, 0.04, 0.07}, 0.025}}}};
  // On its lattice the sand is nowhere denser than its limit, so that the density correction has nothing to do.
  State state = initial_state(scene);
  const Eigen::Vector3d start_velocity(0.6, 0.0, 1.5);
  state.particles.velocities.colwise() = start_velocity;
  testing::tag(state);
  const Eigen::Matrix3Xd start = testing::positions_by_tag(state);
  const double mass = state.particles.masses.sum();
  double highest_pressure = 0.0, euler_offset = 0.0;
  testing::run_for(state, StepSettings{}, 0.2, [&](const State& s, const StepReport& report) {
    highest_pressure = std::max(highest_pressure, pressure_of(s.warm->stress).maxCoeff());
    euler_offset += 0.5 * testing::gravity * report.dt * report.dt;  // forward Euler falls this much further
    EXPECT_EQ(report.particles_left, 0);
  });
  EXPECT_EQ(highest_pressure, 0.0);
  EXPECT_NEAR(state.particles.masses.sum(), mass, 1e-13 * mass);
  Eigen::Vector3d moved = state.time * start_velocity;
  moved[2] -= 0.5 * testing::gravity * state.time * state.time + euler_offset;
  EXPECT_LT(((testing::positions_by_tag(state) - start).colwise() - moved).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT(
      (state.particles.velocities.colwise() - Eigen::Vector3d(0.6, 0.0, 1.5 - testing::gravity * state.time))
          .cwiseAbs()
          .maxCoeff(),
      1e-12);
}

TEST(FreeFlight, OfLooseSandOffAPressedBedIsNotHeldBack) {
  // The skin of a bed has friction by the pressure beside it; it must not pull at what leaves (no cohesion).
  const double h = 0.01, mu = 0.577, speed = 0.3;
  Scene scene = testing::box_scene({6, 6, 12}, {6.0, 6.0, 5.0}, h, mu);
  scene.grid.periodic = {true, true, false};
  scene.sides[2][0] = {true, mu};
  scene.fillings.push_back(
      testing::box_of(0, h * Eigen::Vector3d(0.0, 0.0, 5.0), h * Eigen::Vector3d(6.0, 6.0, 5.25)));
  State state = initial_state(scene);
  const Eigen::Index bed = 6 * 6 * 5 * 8;
  const auto loose = [&] { return Eigen::Index(state.particles.count() - bed); };
  StepSettings settings;
  settings.reshape = false;
  testing::run_for(state, settings, 0.002, [](const State&, const StepReport&) {});  // the bed presses
  state.particles.velocities.rightCols(loose()).colwise() = Eigen::Vector3d(0.0, 0.0, speed);
  for (int i = 0; i < 3; ++i)
    testing::run_for(state, settings, 0.002, [](const State&, const StepReport&) {});
  const double expected = speed - testing::gravity * 0.006;
  EXPECT_NEAR(state.particles.velocities.row(2).tail(loose()).mean(), expected, 0.02 * expected);
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
