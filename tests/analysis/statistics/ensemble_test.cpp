#include "analysis/statistics/ensemble.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stdexcept>

namespace talus::analysis {
namespace {

TEST(EnsembleStatistics, MeanAndSampleDeviation) {
  const std::array values{2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0};  // squared deviations sum to 32
  const auto statistics = ensemble_statistics(values);
  EXPECT_EQ(statistics.count, 8u);
  EXPECT_DOUBLE_EQ(statistics.mean, 5.0);
  EXPECT_DOUBLE_EQ(statistics.standard_deviation, std::sqrt(32.0 / 7.0));
}

TEST(EnsembleStatistics, SmallSpreadOnALargeMeanIsNotLost) {
  const std::array values{1e9 + 1.0, 1e9 + 2.0, 1e9 + 3.0};
  EXPECT_DOUBLE_EQ(ensemble_statistics(values).standard_deviation, 1.0);
}

TEST(EnsembleStatistics, OneMemberHasNoSpread) {
  const std::array values{3.0};
  const auto statistics = ensemble_statistics(values);
  EXPECT_EQ(statistics.count, 1u);
  EXPECT_DOUBLE_EQ(statistics.mean, 3.0);
  EXPECT_TRUE(std::isnan(statistics.standard_deviation));
}

TEST(EnsembleStatistics, NoMembersIsAnError) { EXPECT_THROW(ensemble_statistics({}), std::invalid_argument); }

}  // namespace
}  // namespace talus::analysis
