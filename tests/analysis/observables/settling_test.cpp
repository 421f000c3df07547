#include "analysis/observables/settling.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace talus::analysis {
namespace {

TEST(Settling, TimeIsLinearBetweenSamples) {
  const std::array time{0.0, 1.0, 2.0, 3.0};
  const std::array curve{0.0, 80.0, 100.0, 100.0};
  // Within 10 of 100 for good halfway between 80 and 100.
  EXPECT_DOUBLE_EQ(settling_time(time, curve, 0.1), 1.5);
}

TEST(Settling, ALateExcursionCounts) {
  const std::array time{0.0, 1.0, 2.0, 3.0};
  const std::array curve{0.0, 100.0, 120.0, 100.0};
  EXPECT_DOUBLE_EQ(settling_time(time, curve, 0.1), 2.5);
}

TEST(Settling, WhatNeverMovedSettledAtOnce) {
  const std::array time{1.0, 2.0};
  const std::array curve{5.0, 5.0};
  EXPECT_DOUBLE_EQ(settling_time(time, curve, 0.1), 1.0);
}

TEST(Settling, RangeCoversTheLastTenthWhole) {
  const std::array time{0.0, 8.0, 8.5, 9.2, 10.0};
  const std::array curve{0.0, 1.0, 3.0, 3.5, 3.2};
  EXPECT_DOUBLE_EQ(range_at_end(time, curve), 0.5);  // from the sample at 8.5, not after 9, on
}

TEST(Settling, OneSampleShowsNoRest) {
  const std::array one{0.0};
  EXPECT_TRUE(std::isinf(range_at_end(one, one)));
}

}  // namespace
}  // namespace talus::analysis
