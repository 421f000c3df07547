// A hundred thousand steps: memory stays flat, mass exact, and energy never rises. Takes some ten minutes, so it is labelled slow.
#include <gtest/gtest.h>
#include <malloc.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "continuum/io/budget.h"
#include "tests/continuum/scenes.h"

namespace talus {
namespace {

constexpr double h = 0.01;  // m

/// Of the process now, MB.
double resident_mb() {
  malloc_trim(0);
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) return std::stod(line.substr(6)) / 1024.0;
  }
  return 0.0;
}

TEST(Endurance, AHundredThousandStepsLeaveMemoryFlatMassExactAndEnergyFalling) {
  constexpr int steps = 100'000;
  constexpr double dt = 5e-4;  // s
  Scene scene = testing::box_scene({12, 3, 8}, {4.0, 3.0, 6.0}, h, testing::mu_of_deg(30.0));
  scene.grid.periodic[1] = true;
  scene.sides[0][0] = {true, 0.0};
  scene.sides[2][0] = {true, 0.5};
  scene.jitter = 0.0;  // a jittered lattice starts overfull, and what the density correction lifts has energy
  scene.bodies = {make_body("ball", Shape{Sphere{{0.02, 0.015, 0.072}, 0.01}}, 1500.0)};
  scene.render_points_per_particle = 4;
  State state = initial_state(scene);
  Budget budget(state);
  double settled_mb = 0.0;
  for (int i = 0; i < steps; ++i) {
    const StepReport report = step(state, StepSettings{}, dt);
    budget.add(state, report);
    if (i == steps / 10) settled_mb = resident_mb();
  }
  const double end_mb = resident_mb();
  const nlohmann::json books = budget.summary();
  std::printf(
      "%d steps, %.1f s simulated; %.2f MB after a tenth, %.2f MB at the end; mass off by %.1e; energy %.6g "
      "J at the "
      "start, %.6g J at most\n",
      steps, state.time, settled_mb, end_mb, books["mass_error"].get<double>(),
      books["energy_start_j"].get<double>(), books["energy_highest_j"].get<double>());
  EXPECT_EQ(books["steps"], steps);
  EXPECT_LE(end_mb, 1.02 * settled_mb);
  EXPECT_NEAR(books["mass_error"].get<double>(), 0.0, 1e-12);
  EXPECT_LE(books["energy_highest_j"].get<double>(), books["energy_start_j"].get<double>() * (1.0 + 1e-9));
  EXPECT_EQ(books["cap_hits"], 0);
}

}  // namespace
}  // namespace talus
