// The impact ruler on a bed of random points and a sphere whose motion is given.
#include "analysis/observables/impact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace talus::analysis {
namespace {

constexpr double side = 0.1, height = 0.05, radius = 0.01;  // m
constexpr double volume_fraction = 0.6;
constexpr double contact_time = 0.0123, interval = 0.005, speed = 1.0, slowing = 20.0;  // s, s, m/s, m/s^2
const ImpactRuler ruler{radius, side, 0.005};

/// Level, but for a round hole of `hole` (m) to the floor.
Snapshot bed(double time, double hole) {
  constexpr int count = 200000;
  std::mt19937_64 bits(3);
  std::uniform_real_distribution<double> across(-0.5 * side, 0.5 * side), up(0.0, height);
  Snapshot snapshot{time, Vectors(3, count), Vectors::Zero(3, count), Eigen::VectorXd::Zero(count)};
  Eigen::Index kept = 0;
  while (kept < count) {
    const Eigen::Vector3d place(across(bits), across(bits), up(bits));
    if (place.head<2>().norm() < hole) continue;
    snapshot.positions.col(kept++) = place;
  }
  const double area = side * side - M_PI * hole * hole;
  snapshot.volumes.setConstant(volume_fraction * area * height / count);
  return snapshot;
}

/// Falls at `speed` until contact, then is slowed evenly to rest.
BodyTrack fall(double end) {
  BodyTrack track;
  for (int k = 0; k * interval <= end + 1e-12; ++k) {
    const double t = k * interval - contact_time, slow = std::min(std::max(t, 0.0), speed / slowing);
    const double depth = t < 0.0 ? speed * t : speed * slow - 0.5 * slowing * slow * slow;
    track.push_back(
        {k * interval, {0.0, 0.0, height - depth + radius}, {0.0, 0.0, -(speed - slowing * slow)}});
  }
  return track;
}

constexpr double depth_at_rest = 0.5 * speed * speed / slowing;

TEST(Impact, DepthTimeAndSpeedAreThoseOfTheMotion) {
  const auto m = measure_impact({bed(0.0, 0.0), bed(0.2, 0.0)}, fall(0.2), ruler);
  const auto& o = m.observables;
  EXPECT_NEAR(o.settled_height, height, 2e-4);
  EXPECT_NEAR(o.settled_volume_fraction, volume_fraction, 3e-3);
  EXPECT_NEAR(o.penetration_depth, depth_at_rest, 2e-4);
  EXPECT_NEAR(o.contact_speed, speed, 0.06);  // rows straddle the contact
  EXPECT_NEAR(o.stop_time, 0.95 * speed / slowing, 2e-3);
  EXPECT_TRUE(o.at_rest);
  EXPECT_NEAR(o.lost_volume, 0.0, 1e-12);
}

TEST(Impact, CurvesCountFromContactAndEndTogether) {
  const auto m = measure_impact({bed(0.0, 0.0), bed(0.2, 0.0)}, fall(0.2), ruler);
  ASSERT_EQ(m.curves.time.size(), 37u);  // nine tenths of 40 intervals
  EXPECT_EQ(m.curves.time.front(), 0.0);
  EXPECT_NEAR(m.curves.depth.front(), 0.0, 1e-12);
  for (std::size_t k = 0; k < m.curves.time.size(); ++k) {
    const double t = std::min(m.curves.time[k], speed / slowing);
    EXPECT_NEAR(m.curves.depth[k], speed * t - 0.5 * slowing * t * t, 4e-4) << k;
  }
}

TEST(Impact, ProfileShowsTheHole) {
  const double hole = 0.02;
  const auto m = measure_impact({bed(0.0, 0.0), bed(0.2, hole)}, fall(0.2), ruler);
  EXPECT_NEAR(m.final_profile.depth.front(), 0.0, 1e-12);
  EXPECT_NEAR(m.final_profile.depth.back(), height, 0.02 * height);
  EXPECT_LE(m.final_profile.x.back() + 1.4 * ruler.bin_width, 0.5 * side);
}

// 0.4 mm over the last tenth: slower than counts as falling, and two times what counts as rest.
TEST(Impact, OneThatStillSinksIsNotAtRest) {
  BodyTrack sinking = fall(0.2);
  for (auto& moment : sinking)
    moment.position.z() -= 0.02 * std::max(0.0, moment.time - contact_time - speed / slowing);
  const auto m = measure_impact({bed(0.0, 0.0), bed(0.2, 0.0)}, sinking, ruler);
  EXPECT_FALSE(m.observables.at_rest);
}

TEST(Impact, RefusesWhatIsNoImpact) {
  const SnapshotSeries series{bed(0.0, 0.0), bed(0.2, 0.0)};
  EXPECT_THROW(measure_impact({}, fall(0.2), ruler), SnapshotError);
  EXPECT_THROW(measure_impact(series, {}, ruler), SnapshotError);
  BodyTrack below = fall(0.2), above = fall(0.2);
  for (auto& moment : below) moment.position.z() -= 0.02;
  for (auto& moment : above) moment.position.z() += 0.2;
  EXPECT_THROW(measure_impact(series, below, ruler), SnapshotError);
  EXPECT_THROW(measure_impact(series, above, ruler), SnapshotError);
  BodyTrack unstopped = fall(0.2);
  for (auto& moment : unstopped) moment.velocity.z() = -speed;
  EXPECT_THROW(measure_impact(series, unstopped, ruler), SnapshotError);
}

}  // namespace
}  // namespace talus::analysis
