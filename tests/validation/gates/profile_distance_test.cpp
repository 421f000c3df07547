#include "validation/gates/profile_distance.h"

#include <gtest/gtest.h>

namespace talus::validation {
namespace {

const Profile triangle{{0.0, 1.0, 2.0}, {1.0, 0.5, 0.0}};

TEST(ProfileDistance, AreasAreThoseOfTrapezia) {
  EXPECT_NEAR(area(triangle), 1.0, 1e-12);
  const Profile box{{0.0, 1.0}, {1.0, 1.0}};
  EXPECT_NEAR(area(box), 1.0, 1e-12);
  EXPECT_EQ(area_between(triangle, triangle), 0.0);
  EXPECT_EQ(area_between(triangle, {}), area(triangle));
}

TEST(ProfileDistance, TakesTheOddPlacesOfBoth) {
  const Profile finer{{0.0, 0.5, 1.0, 1.5, 2.0}, {1.0, 0.75, 0.5, 0.25, 0.0}};
  EXPECT_NEAR(area_between(triangle, finer), 0.0, 1e-12);
  const Profile higher{{0.0, 0.7, 2.0}, {1.1, 0.75, 0.1}};
  EXPECT_NEAR(area_between(triangle, higher), 0.2, 1e-12);
  EXPECT_NEAR(area_between(triangle, higher), area_between(higher, triangle), 1e-15);
}

TEST(ProfileDistance, MeansLeaveOutWhatIsMissing) {
  const Profile flat{{0.0, 2.0}, {0.5, 0.5}};
  const Profile mean = mean_profile({triangle, {}, flat});
  EXPECT_NEAR(depth_at(mean, 0.0), 0.75, 1e-12);
  EXPECT_NEAR(depth_at(mean, 0.5), 0.625, 1e-12);
  EXPECT_NEAR(depth_at(mean, 2.0), 0.25, 1e-12);
  EXPECT_EQ(depth_at(mean, 2.1), 0.0);
}

TEST(ProfileDistance, ARunWithoutAProfileHasAnEmptyOne) {
  EXPECT_TRUE(profile_of({{"code", "yade"}}, "profile_L1").x.empty());
  EXPECT_TRUE(profile_of({{"final_profile", nullptr}}, "profile_L1").x.empty());
  const nlohmann::json run{{"final_profile", {{"x", {0.0, 1.0}}, {"depth", {2.0, 3.0}}}},
                           {"curves", {{"time", {0.0, 0.5}}, {"depth", {4.0, 5.0}}}}};
  EXPECT_EQ(profile_of(run, "profile_L1").depth.back(), 3.0);
  EXPECT_EQ(profile_of(run, "depth_curve_L1").x.back(), 0.5);
  EXPECT_EQ(profile_of(run, "depth_curve_L1").depth.back(), 5.0);
}

}  // namespace
}  // namespace talus::validation
