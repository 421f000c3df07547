// Piles and heaps (method.md, section 12): below asin(mu) a pile holds, above it fails; a heap at rest keeps its bulk volume.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/continuum/scenes.h"

namespace talus {
namespace {

constexpr double h = 0.01;      // m
constexpr double mu = 0.5;      // asin 30, atan 26.6 degrees
constexpr int half_width = 30;  // cells, L

/// A wedge of sand on a rough floor, plane strain, both flanks at `angle_deg`.
State pile(double angle_deg) {
  const double slope = std::tan(angle_deg * std::numbers::pi / 180.0);
  const int columns = 2 * half_width + 20, rows = static_cast<int>(half_width * slope) + 4;
  Scene scene = testing::box_scene({columns, 1, rows}, {1.0 * columns, 1.0, rows - 2.0}, h, mu);
  scene.grid.periodic[1] = true;
  scene.sides[2][0] = {true, mu};
  scene.jitter = 0.5;
  State state = initial_state(scene);
  Particles& p = state.particles;
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < p.count(); ++i) {
    if (p.positions(2, i) < (half_width * h - std::abs(p.positions(0, i) - 0.5 * columns * h)) * slope)
      p.copy(i, kept++);
  }
  p.resize(kept);
  return state;
}

/// Height of the centre of mass, m.
double centre(const State& state) {
  const Particles& p = state.particles;
  return p.positions.row(2).dot(p.masses.matrix()) / p.masses.sum();
}

struct Rest {
  double settled;             // fall of the centre of mass over the pile's height, in the first 10 sqrt(L/g)
  double drift;               // and in the 60 sqrt(L/g) after that
  double bulk_volume_change;  // relative, over those 60
  int cap_hits = 0;
};

Rest rest(double angle_deg) {
  State state = pile(angle_deg);
  const double height = half_width * h * std::tan(angle_deg * std::numbers::pi / 180.0);
  const double unit = std::sqrt(half_width * h / testing::gravity), start = centre(state);
  Rest result{};
  double volume = 0.0;
  const auto observe = [&](const State&, const StepReport& report) {
    result.cap_hits += report.cap_hits();
    volume = report.packing.bulk_volume;
  };
  testing::run_for(state, testing::step_settings(), 10.0 * unit, observe);
  const double settled = centre(state), settled_volume = volume;
  testing::run_for(state, testing::step_settings(), 60.0 * unit, observe);
  result.settled = (start - settled) / height;
  result.drift = (settled - centre(state)) / height;
  result.bulk_volume_change = volume / settled_volume - 1.0;
  fmt::print(
      "[ measured ] pile at {} deg (asin mu = 30): settles by {:.5f} of its height in 10 sqrt(L/g), drifts "
      "{:.6f} in "
      "60 more, bulk volume changes by {:.5f}\n",
      angle_deg, result.settled, result.drift, result.bulk_volume_change);
  return result;
}

TEST(Pile, HoldsBelowArcsineOfMuAndKeepsItsVolume) {
  const Rest result = rest(28.0);
  EXPECT_EQ(result.cap_hits, 0);
  EXPECT_LT(result.settled, 0.005);
  EXPECT_LT(std::abs(result.drift), 1e-4);
  EXPECT_LT(std::abs(result.bulk_volume_change), 0.002);
}

TEST(Pile, FailsAboveArcsineOfMu) {
  const Rest result = rest(33.0);
  EXPECT_GT(result.settled, 0.03);
}

}  // namespace
}  // namespace talus
