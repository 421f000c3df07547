// Solids of revolution: distances known by hand, motions that must not matter, profiles that are refused.
#include "continuum/solids/revolved.h"

#include <gmock/gmock.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <numbers>

namespace talus {
namespace {

using ::testing::HasSubstr;

const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();

TEST(Revolved, CylinderDistancesKnownByHand) {
  const Revolved solid = cylinder({0, 0, 1}, up, 2.0, 5.0);
  EXPECT_DOUBLE_EQ(signed_distance(solid, {5, 0, 3}), 3.0);      // side
  EXPECT_DOUBLE_EQ(signed_distance(solid, {0, 5, 10}), 5.0);     // rim: 3 and 4
  EXPECT_DOUBLE_EQ(signed_distance(solid, {1, 0, 7}), 1.0);      // top
  EXPECT_DOUBLE_EQ(signed_distance(solid, {0, 0, 3.25}), -2.0);  // on the axis, which is no surface
  EXPECT_DOUBLE_EQ(signed_distance(solid, {0, 0, 1.5}), -0.5);   // bottom
}

TEST(Revolved, ConeDistancesKnownByHand) {
  const Revolved solid = cone(origin, up, 3.0, 0.0, 4.0);    // its side is 5 long
  EXPECT_DOUBLE_EQ(signed_distance(solid, {0, 0, 6}), 2.0);  // above the apex
  EXPECT_NEAR(signed_distance(solid, {3, 0, 4}), 12.0 / 5.0, 1e-14);
  EXPECT_NEAR(signed_distance(solid, {0, 0, 3}), -3.0 / 5.0, 1e-14);
}

TEST(Revolved, HourglassIsAsLongAsItsPartsAndMayLackSome) {
  const Revolved whole = hourglass(origin, up, {0.5, 0.2, 0.1, 0.3, std::numbers::pi / 4});
  EXPECT_NEAR(bounds(whole).sizes().z(), 2 * (0.2 + 0.4) + 0.3, 1e-14);
  EXPECT_NEAR(signed_distance(whole, {0, 0, 0.75}), -0.1, 1e-14);
  const Revolved bare = hourglass(origin, up, {0.5, 0.0, 0.1, 0.0, std::numbers::pi / 4});
  EXPECT_NEAR(bounds(bare).sizes().z(), 2 * 0.4, 1e-14);
  EXPECT_EQ(profile_fault(whole.profile), std::nullopt);
  EXPECT_EQ(profile_fault(bare.profile), std::nullopt);
  EXPECT_NEAR(signed_distance(bare, {0.1, 0, 0.4}), 0.0, 1e-14);
}

TEST(Revolved, HourglassConesHaveTheirAngleFromTheAxis) {
  const Revolved solid = hourglass(origin, up, {0.5, 0.2, 0.1, 0.3, std::numbers::pi / 6});
  const double cone_height = 0.4 * std::sqrt(3.0);
  EXPECT_NEAR(bounds(solid).sizes().z(), 2 * (0.2 + cone_height) + 0.3, 1e-14);
  EXPECT_NEAR(signed_distance(solid, {0.3, 0, 0.2 + 0.5 * cone_height}), 0.0, 1e-14);
}

TEST(Revolved, SignsAreRightLevelWithTheCorners) {
  const Revolved ring{origin, up, {{1, 0}, {2, -1}, {3, 0}, {2, 1}}};
  EXPECT_DOUBLE_EQ(signed_distance(ring, {0, 0, 0}), 1.0);
  EXPECT_DOUBLE_EQ(signed_distance(ring, {2, 0, 0}), -std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(signed_distance(ring, {4, 0, 0}), 1.0);
  EXPECT_DOUBLE_EQ(signed_distance(ring, {1, 0, 1}), std::sqrt(0.5));
  EXPECT_DOUBLE_EQ(signed_distance(ring, {1, 0, -1}), std::sqrt(0.5));
}

/// A direction from two angles in whole degrees.
Eigen::Vector3d arbitrary_direction() {
  const double turn = *rc::gen::inRange(0, 360) * std::numbers::pi / 180.0;
  const double tilt = *rc::gen::inRange(0, 181) * std::numbers::pi / 180.0;
  return {std::sin(tilt) * std::cos(turn), std::sin(tilt) * std::sin(turn), std::cos(tilt)};
}

Eigen::Vector3d arbitrary_point() {
  const auto coordinate = rc::gen::inRange(-3000, 3001);
  const double x = *coordinate, y = *coordinate, z = *coordinate;
  return 1e-3 * Eigen::Vector3d(x, y, z);
}

/// A star-shaped polygon about (1, 0): corners in order of angle, so that it never crosses itself.
std::vector<Eigen::Vector2d> arbitrary_profile() {
  const int corners = *rc::gen::inRange(3, 12);
  std::vector<Eigen::Vector2d> profile;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / corners, reach = 1e-3 * *rc::gen::inRange(100, 1001);
    profile.emplace_back(1.0 + reach * std::cos(angle), reach * std::sin(angle));
  }
  return profile;
}

RC_GTEST_PROP(RevolvedProperty, MovesWithItsSolid, ()) {
  const Revolved solid{arbitrary_point(), arbitrary_direction(), arbitrary_profile()};
  const Eigen::Vector3d at = arbitrary_point(), shift = arbitrary_point();
  const Eigen::AngleAxisd turn(*rc::gen::inRange(-180, 181) * std::numbers::pi / 180.0,
                               arbitrary_direction());
  const Revolved moved{turn * solid.base + shift, turn * solid.axis, solid.profile};
  RC_ASSERT(std::abs(signed_distance(moved, turn * at + shift) - signed_distance(solid, at)) < 1e-10);
}

RC_GTEST_PROP(RevolvedProperty, IsTheSameAllAroundItsAxis, ()) {
  const Revolved solid{arbitrary_point(), arbitrary_direction(), arbitrary_profile()};
  const Eigen::Vector3d at = arbitrary_point();
  const Eigen::AngleAxisd turn(*rc::gen::inRange(-180, 181) * std::numbers::pi / 180.0, solid.axis);
  const double turned = signed_distance(solid, solid.base + turn * (at - solid.base));
  RC_ASSERT(std::abs(turned - signed_distance(solid, at)) < 1e-10);
}

RC_GTEST_PROP(RevolvedProperty, DoesNotDependOnWhereTheProfileStartsNorOnItsSense, ()) {
  const Revolved solid{origin, arbitrary_direction(), arbitrary_profile()};
  Revolved other = solid;
  std::rotate(other.profile.begin(), other.profile.begin() + 2, other.profile.end());
  std::reverse(other.profile.begin(), other.profile.end());
  const Eigen::Vector3d at = arbitrary_point();
  RC_ASSERT(std::abs(signed_distance(other, at) - signed_distance(solid, at)) < 1e-12);
}

RC_GTEST_PROP(RevolvedProperty, SoundProfilesPassAndWithTwoCornersSwappedTheyCross, ()) {
  auto profile = arbitrary_profile();
  RC_ASSERT(profile_fault(profile) == std::nullopt);
  RC_PRE(profile.size() >= 4);
  // On a circle, swapping two neighbours makes the edges on either side of them cross.
  const Eigen::Vector2d centre(1, 0);
  for (Eigen::Vector2d& corner : profile) corner = centre + 0.5 * (corner - centre).normalized();
  RC_ASSERT(profile_fault(profile) == std::nullopt);
  std::swap(profile[1], profile[2]);
  RC_ASSERT(profile_fault(profile).has_value());
}

TEST(ProfileFault, SaysWhatIsWrong) {
  const auto fault = [](std::vector<Eigen::Vector2d> profile) { return profile_fault(profile).value_or(""); };
  EXPECT_EQ(fault({{0, 0}, {1, 0}, {0, 1}}), "");
  EXPECT_THAT(fault({{0, 0}, {1, 0}}), HasSubstr("at least three corners"));
  EXPECT_THAT(fault({{0, 0}, {1, 0}, {-0.5, 1}}), HasSubstr("must not pass the axis, as at [-0.5, 1]"));
  EXPECT_THAT(fault({{0, 0}, {1, 0}, {1, 0}, {0, 1}}), HasSubstr("must not repeat a corner, as at [1, 0]"));
  EXPECT_THAT(fault({{0, 0}, {1, 0}, {0, 1}, {0, 0}}), HasSubstr("repeat a corner, as at [0, 0]"));
  EXPECT_THAT(fault({{0, 0}, {2, 0}, {1, 0}}), HasSubstr("must not fold back on itself, as at [2, 0]"));
  EXPECT_THAT(fault({{0, 0}, {0, 1}, {0, 2}}), HasSubstr("fold back"));
  EXPECT_THAT(fault({{1, 0}, {2, 1}, {2, 0}, {1, 1}}),
              HasSubstr("must not cross or touch itself, as the edges from [1, 0] and [2, 0] do"));
  EXPECT_THAT(fault({{0, 0}, {2, 0}, {2, 2}, {3, 1}}), HasSubstr("the edges from [2, 0] and [3, 1] do"));
  EXPECT_THAT(fault({{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}}), HasSubstr("cross or touch"));
}

}  // namespace
}  // namespace talus
