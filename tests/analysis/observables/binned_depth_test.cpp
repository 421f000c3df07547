#include "analysis/observables/binned_depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "analysis/snapshot.h"

namespace talus::analysis {
namespace {

constexpr double width = 0.01;  // m

TEST(BinnedDepth, SharesAreLinearAndSumToTheVolume) {
  const Eigen::Vector3d places(0.001, 0.0175, 0.02), volumes(1.0, 4.0, 2.0);
  const auto shared = share_by_bins(places, volumes, width, 4);
  EXPECT_DOUBLE_EQ(shared[0], 1.0);
  EXPECT_NEAR(shared[1], 3.0 + 1.0, 1e-12);
  EXPECT_NEAR(shared[2], 1.0 + 1.0, 1e-12);
  EXPECT_EQ(shared[3], 0.0);
}

TEST(BinnedDepth, WhatIsSharedBeyondTheLastBinIsLeftOut) {
  const Eigen::Vector2d places(0.0175, 0.5), volumes(4.0, 2.0);
  const auto shared = share_by_bins(places, volumes, width, 2);
  EXPECT_NEAR(shared[1], 3.0, 1e-12);
}

/// Thin rings of items under the cone h = 1 - 2 r: depth at a ring's radius is on the cone, in the first ring too.
TEST(BinnedDepth, RingsReadAConeExactly) {
  constexpr int circles = 100000;
  constexpr double reach = 0.2;
  Eigen::VectorXd radius(circles), volume(circles);
  for (int k = 0; k < circles; ++k) {
    radius[k] = (k + 0.5) * reach / circles;
    volume[k] = 2.0 * std::numbers::pi * radius[k] * reach / circles * (1.0 - 2.0 * radius[k]);
  }
  constexpr std::size_t bins = 18;
  const auto shared = share_by_bins(radius, volume, width, bins);
  const Rings circle = rings(width, bins);
  for (std::size_t bin = 0; bin < bins; ++bin) {
    EXPECT_NEAR(shared[bin] / circle.area[bin], 1.0 - 2.0 * circle.radius[bin], 1e-6) << bin;
  }
}

TEST(BinnedDepth, FrontIsTheFirstCrossing) {
  const DepthProfile profile{{0.5, 1.5, 2.5, 3.5, 4.5}, {8.0, 4.0, 0.0, 3.0, 3.0}};
  EXPECT_DOUBLE_EQ(front_of(profile, 1.0), 1.5 + 0.75);
  EXPECT_DOUBLE_EQ(front_of(profile, 9.0), 0.0);
  EXPECT_DOUBLE_EQ(front_of(profile, 2.0, 3), 4.5);
  EXPECT_DOUBLE_EQ(front_of(profile, 1.0, 2), 0.0);
}

TEST(BinnedDepth, AnItemAbsurdlyFarAwayHasEscaped) {
  EXPECT_EQ(bins_to_hold(Eigen::Vector2d(0.001, 0.05), width, 0.0), 8u);
  EXPECT_THROW(bins_to_hold(Eigen::Vector2d(0.001, 1e9), width, 0.0), SnapshotError);
}

}  // namespace
}  // namespace talus::analysis
