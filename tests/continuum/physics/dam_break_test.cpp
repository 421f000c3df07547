// Sand without friction is a liquid that cannot pull: its collapse must not depend on the time step (method.md, section 12).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/continuum/scenes.h"

namespace talus {
namespace {

TEST(DamBreak, KineticEnergyDoesNotDependOnTheTimeStep) {
  std::vector<std::vector<double>> energies;
  for (const double share : {1.0, 0.25}) {
    Scene scene = testing::box_scene({80, 1, 26}, {20.0, 1.0, 20.0}, 0.01, 0.0);
    scene.grid.periodic[1] = true;
    scene.sides[0] = {Side{true, 0.0}, Side{true, 0.0}};
    scene.sides[2][0] = {true, 0.0};
    scene.jitter = 0.5;
    State state = initial_state(scene);
    StepSettings settings = testing::step_settings();
    settings.courant *= share;
    settings.gravity_courant *= share;
    energies.emplace_back();
    for (int i = 0; i < 6; ++i) {
      testing::run_for(state, settings, 0.05,
                       [](const State&, const StepReport& report) { EXPECT_EQ(report.cap_hits(), 0); });
      energies.back().push_back(
          0.5 * state.particles.velocities.colwise().squaredNorm().dot(state.particles.masses.matrix()));
    }
  }
  for (std::size_t i = 0; i < energies[0].size(); ++i) {
    const double ratio = energies[0][i] / energies[1][i];
    fmt::print("[ measured ] t = {:.2f} s: kinetic energy at dt over that at dt/4 = {:.4f}\n",
               0.05 * (static_cast<double>(i) + 1.0), ratio);
    EXPECT_NEAR(ratio, 1.0, 0.05);
  }
}

}  // namespace
}  // namespace talus
