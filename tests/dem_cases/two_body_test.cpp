// One or two grains in the real LIGGGHTS and YADE, against what mechanics says of them.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/dem_cases/case_files.h"
#include "tests/dem_cases/codes.h"

namespace talus::dem {
namespace {

constexpr double radius = 0.0015;  // m
constexpr double gravity = 9.81;   // m/s^2

struct Grain {
  Eigen::Vector3d position, velocity;
};

/// A long flat floor with nothing else near, and grains that are free from the start.
Case bench(double g, double rolling_friction) {
  Case a_case = read_case(tiny_column_file);
  column_geometry(a_case).rough_floor = false;
  column_geometry(a_case).column_length = 0.3;
  column_geometry(a_case).tank_length = 0.6;
  a_case.contact.rolling_friction = rolling_friction;
  a_case.protocol.gravity = g;
  a_case.protocol.settle_time = 0.0;
  a_case.protocol.run_time = 0.07;
  a_case.protocol.snapshot_interval = 0.0035;
  a_case.protocol.time_step = 1e-5 * 0.7;
  a_case.protocol.rest_energy = std::numeric_limits<double>::infinity();
  return a_case;
}

Packing packing_of(const std::vector<Grain>& grains) {
  const auto count = static_cast<Eigen::Index>(grains.size());
  Packing packing{.seed = 0,
                  .fixed_count = 0,
                  .positions = Eigen::Matrix3Xd(3, count),
                  .velocities = Eigen::Matrix3Xd(3, count),
                  .radii = Eigen::VectorXd::Constant(count, radius)};
  for (Eigen::Index i = 0; i < count; ++i) {
    packing.positions.col(i) = grains[static_cast<std::size_t>(i)].position;
    packing.velocities.col(i) = grains[static_cast<std::size_t>(i)].velocity;
  }
  return packing;
}

class TwoBodies : public ::testing::TestWithParam<Code> {
 protected:
  analysis::SnapshotSeries series_of(const Case& a_case, const std::vector<Grain>& grains) {
    const Packing packing = packing_of(grains);
    GetParam().write_input(a_case, packing, folder_.path());
    const auto result = run(GetParam(), folder_.path());
    EXPECT_EQ(result.exit_code, 0) << GetParam().failure_text(folder_.path());
    return GetParam().read_output(a_case, packing, folder_.path());
  }

  TestFolder folder_;
};

/// How deep a grain at rest sinks into the floor under its weight, by Hertz.
double resting_overlap(const Case& a_case) {
  const double mass = a_case.grains.density * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  const double modulus = a_case.grains.youngs_modulus /
                         (2.0 * (1.0 - a_case.grains.poissons_ratio * a_case.grains.poissons_ratio));
  return std::pow(3.0 * mass * gravity / (4.0 * modulus * std::sqrt(radius)), 2.0 / 3.0);
}

// The codes' damping gives 0.54 (LIGGGHTS, whose force may not pull) and 0.49 (YADE) where 0.5 is asked for: dem.md.
TEST_P(TwoBodies, CollideHeadOnWithTheRestitutionOfTheCase) {
  const double speed = 0.2;
  const auto series = series_of(bench(1e-9, 0.0), {{{0.10, 0.004, 0.05}, {speed, 0.0, 0.0}},
                                                   {{0.105, 0.004, 0.05}, {-speed, 0.0, 0.0}}});
  const auto& v = series.back().velocities;
  EXPECT_NEAR((v(0, 1) - v(0, 0)) / (2.0 * speed), 0.5, 0.05);
  EXPECT_NEAR(v(0, 0) + v(0, 1), 0.0, 1e-9 * speed);  // momentum
  EXPECT_LT(v.bottomRows(2).cwiseAbs().maxCoeff(), 1e-7);
}

TEST_P(TwoBodies, AnObliqueCollisionConservesMomentumAndLosesEnergy) {
  const auto series = series_of(bench(1e-9, 0.2), {{{0.10, 0.004, 0.05}, {0.3, 0.02, 0.0}},
                                                   {{0.105, 0.004, 0.0512}, {-0.1, 0.0, -0.05}}});
  const auto &before = series.front().velocities, &after = series.back().velocities;
  const Eigen::Vector3d moved = after.rowwise().sum() - before.rowwise().sum();
  EXPECT_LT(moved.norm(), 1e-7);
  EXPECT_GT((after - before).norm(), 0.05);  // they did meet
  EXPECT_LT(after.squaredNorm(), before.squaredNorm());
}

// Coulomb: mu g while it slides; then it rolls, at 5/7 of the speed it had.
TEST_P(TwoBodies, SlidesAtTheFrictionAndThenRolls) {
  const double speed = 0.2, mu = 0.5;
  const Case a_case = bench(gravity, 0.0);
  const auto series =
      series_of(a_case, {{{0.05, 0.004, radius - resting_overlap(a_case)}, {speed, 0.0, 0.0}}});
  const double sliding = 2.0 * speed / (7.0 * mu * gravity);  // s, 11.6 ms
  ASSERT_GT(sliding, series[3].time);
  EXPECT_NEAR((speed - series[3].velocities(0, 0)) / series[3].time, mu * gravity, 0.02 * mu * gravity);
  for (const auto& snapshot : series) {
    if (snapshot.time > 1.2 * sliding) {
      EXPECT_NEAR(snapshot.velocities(0, 0), 5.0 / 7.0 * speed, 0.01 * speed);
    }
  }
}

// The moment mu_r/2 R m g (a plane counts as a grain of equal size) slows a rolling sphere by 5/7 mu_r/2 g.
TEST_P(TwoBodies, RollingFrictionSlowsARollingGrain) {
  const double speed = 0.2, rolling_friction = 0.2;
  const Case a_case = bench(gravity, rolling_friction);
  const auto series =
      series_of(a_case, {{{0.05, 0.004, radius - resting_overlap(a_case)}, {speed, 0.0, 0.0}}});
  const auto &early = series[6], &late = series[14];  // 21 and 49 ms: it rolls
  const double slowed = (early.velocities(0, 0) - late.velocities(0, 0)) / (late.time - early.time);
  const double expected = 5.0 / 7.0 * 0.5 * rolling_friction * gravity;
  EXPECT_NEAR(slowed, expected, 0.05 * expected);
}

// Energy: no rebound is higher than e^2 of the fall, and none gains.
TEST_P(TwoBodies, ADroppedGrainReboundsByTheSquareOfTheRestitution) {
  Case a_case = bench(gravity, 0.0);
  a_case.protocol.run_time = 0.07;
  const double drop = 0.005;
  const auto series = series_of(a_case, {{{0.05, 0.004, radius + drop}, Eigen::Vector3d::Zero()}});
  double highest = 0.0;
  const double fall = std::sqrt(2.0 * drop / gravity);  // s, 31.9 ms
  for (const auto& snapshot : series) {
    const double height = snapshot.positions(2, 0) - radius;
    const double energy = gravity * height + 0.5 * snapshot.velocities.squaredNorm();
    EXPECT_LE(energy, gravity * drop * (1.0 + 1e-3));
    if (snapshot.time > fall + 0.002) highest = std::max(highest, energy / (gravity * drop));
  }
  EXPECT_NEAR(std::sqrt(highest), 0.5, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Codes, TwoBodies, ::testing::Values(liggghts_code, yade_code),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace talus::dem
