// A coarse column collapse: energy only falls, mass is kept, the heap comes to rest, and friction matters.
#include <gtest/gtest.h>

#include "continuum/io/budget.h"
#include "tests/continuum/scenes.h"

namespace talus {
namespace {

Scene column(double friction) {
  Scene scene = testing::box_scene({60, 1, 14}, {10.0, 1.0, 10.0}, 0.01, friction);
  scene.grid.periodic[1] = true;
  scene.sides[0] = {Side{true, 0.0}, Side{true, 0.0}};
  scene.sides[2][0] = {true, friction};
  scene.jitter = 0.5;
  return scene;
}

double front(const State& state) { return state.particles.positions.row(0).maxCoeff(); }

TEST(ColumnCollapse, LosesEnergyKeepsMassAndComesToRest) {
  State state = initial_state(column(testing::mu_of_deg(30.0)));
  const double start = total_energy(state), mass = state.particles.masses.sum();
  double highest = start;
  int cap_hits = 0;
  testing::run_for(state, StepSettings{}, 1.0, [&](const State& s, const StepReport& report) {
    highest = std::max(highest, total_energy(s));
    cap_hits += report.projection.cap_hits;
    EXPECT_LE(report.largest_move, 0.5);
  });
  EXPECT_LE(highest, start * 1.001);
  EXPECT_NEAR(state.particles.masses.sum(), mass, 1e-12 * mass);
  EXPECT_EQ(cap_hits, 0);
  const double spread = front(state);
  EXPECT_GT(spread, 0.15);
  EXPECT_LT(spread, 0.30);
  testing::run_for(state, StepSettings{}, 0.5, [](const State&, const StepReport&) {});
  EXPECT_NEAR(front(state), spread, 0.002);
}

TEST(ColumnCollapse, LessFrictionRunsFurther) {
  std::vector<double> fronts;
  for (const double angle : {35.0, 20.0, 5.0}) {
    State state = initial_state(column(testing::mu_of_deg(angle)));
    testing::run_for(state, StepSettings{}, 0.4, [](const State&, const StepReport&) {});
    fronts.push_back(front(state));
  }
  EXPECT_LT(fronts[0] + 0.02, fronts[1]);
  EXPECT_LT(fronts[1] + 0.02, fronts[2]);
}

TEST(ColumnCollapse, PlaneStrainKeepsOutOfTheThirdDirection) {
  State state = initial_state(column(testing::mu_of_deg(30.0)));
  testing::run_for(state, StepSettings{}, 0.2, [](const State&, const StepReport&) {});
  EXPECT_EQ(state.particles.velocities.row(1).cwiseAbs().maxCoeff(), 0.0);
}

TEST(ColumnCollapse, RepeatsToTheLastBit) {
  const auto run = [] {
    State state = initial_state(column(testing::mu_of_deg(30.0)));
    testing::run_for(state, StepSettings{}, 0.1, [](const State&, const StepReport&) {});
    return state.particles.positions;
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace talus
