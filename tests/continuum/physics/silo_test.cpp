// A flat-bottomed silo, and an hourglass: friction keeps the rate of discharge constant, while without it the rate falls
// with the fill (method.md, section 12).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numeric>

#include "tests/continuum/scenes.h"

namespace talus {
namespace {

using Eigen::Vector3d;

constexpr double h = 0.01;                           // m
constexpr int below = 4;                             // cells of free fall under the floor
constexpr int width = 32, height = 64, opening = 8;  // cells

/// Plane strain. The floor is two plates that leave the opening between them; what falls through it leaves the domain.
State silo(double friction) {
  Scene scene = testing::box_scene({width, 1, below + height + 2}, {1.0, 1.0, 1.0}, h, friction);
  scene.fillings = {
      testing::box_of(0, Vector3d(0.0, 0.0, below * h), h * Vector3d(width, 1.0, below + height))};
  scene.grid.periodic[1] = true;
  scene.sides[0] = {Side{true, friction}, Side{true, friction}};
  scene.jitter = 0.5;
  const auto plate = [&](double from, double to) {
    return Wall{testing::box_of(0, h * Vector3d(from, -5.0, -5.0), h * Vector3d(to, 5.0, below)).shape,
                friction};
  };
  scene.walls = {plate(-10.0, 0.5 * (width - opening)), plate(0.5 * (width + opening), width + 10.0)};
  return initial_state(scene);
}

struct Discharge {
  std::vector<double> rates;  // kg/s in windows of equal length, from 90 % of the fill down to 45 %
  int cap_hits = 0;
};

Discharge discharge(State state) {
  constexpr double window = 0.1;  // s
  const double start = state.particles.masses.sum();
  Discharge result;
  double left = 0.0;
  while (state.particles.masses.sum() > 0.45 * start) {
    const bool counts = state.particles.masses.sum() < 0.9 * start;
    const double before = left;
    testing::run_for(state, testing::step_settings(), window, [&](const State&, const StepReport& report) {
      left += report.mass_left;
      result.cap_hits += report.cap_hits();
    });
    EXPECT_NEAR(state.particles.masses.sum() + left, start, 1e-10 * start);
    if (counts) result.rates.push_back((left - before) / window);
  }
  return result;
}

TEST(Silo, FrictionKeepsTheRateWhileTheFillHalves) {
  const Discharge result = discharge(silo(0.5));
  ASSERT_GE(result.rates.size(), 6u);
  EXPECT_EQ(result.cap_hits, 0);
  // Means of the first and of the second half, which single surges do not decide.
  const auto half = static_cast<std::ptrdiff_t>(result.rates.size() / 2);
  const auto mean = [&](auto first, auto last) {
    return std::accumulate(first, last, 0.0) / static_cast<double>(last - first);
  };
  const double early = mean(result.rates.begin(), result.rates.begin() + half);
  const double late = mean(result.rates.end() - half, result.rates.end());
  fmt::print("[ measured ] with friction: rate of the later half over the earlier {:.4f}; windows",
             late / early);
  for (const double rate : result.rates) fmt::print(" {:.3f}", rate / early);
  fmt::print("\n");
  EXPECT_NEAR(late / early, 1.0, 0.03);
}

TEST(Silo, WithoutFrictionTheRateFallsWithTheFill) {
  const Discharge result = discharge(silo(0.0));
  ASSERT_GE(result.rates.size(), 4u);
  fmt::print("[ measured ] without friction: last rate over first {:.3f}\n",
             result.rates.back() / result.rates.front());
  // Torricelli: sqrt of the fill, (0.45 / 0.9)^(1/2) = 0.71 at the ends; windows average over some of that.
  EXPECT_LT(result.rates.back() / result.rates.front(), 0.85);
  EXPECT_GT(result.rates.back() / result.rates.front(), 0.60);
}

}  // namespace
}  // namespace talus
