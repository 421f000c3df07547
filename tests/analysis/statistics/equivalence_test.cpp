#include "analysis/statistics/equivalence.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace talus::analysis {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(Equivalence, WorkedExamples) {
  // P(T > 3) with 10 degrees of freedom, and P(T > 2) with 4, by integrating the density.
  const Equivalence close = test_equivalence(0.02, 0.01, 10.0, 0.05);
  EXPECT_NEAR(close.p, 0.00667183, 1e-8);
  EXPECT_TRUE(close.equivalent);
  const Equivalence unclear = test_equivalence(-0.03, 0.01, 4.0, 0.05);
  EXPECT_NEAR(unclear.p, 0.05805826, 1e-8);
  EXPECT_FALSE(unclear.equivalent);
  EXPECT_TRUE(test_equivalence(-0.03, 0.01, 4.0, 0.05, 0.06).equivalent);
}

TEST(Equivalence, IsTheIntervalWithinTheBand) {
  // t_10 = 1.812461 at 0.05: the interval 0.02 +- u t ends at the band for u = 0.03 / t.
  EXPECT_TRUE(test_equivalence(0.02, 0.03 / 1.8125, 10.0, 0.05).equivalent);
  EXPECT_FALSE(test_equivalence(0.02, 0.03 / 1.8124, 10.0, 0.05).equivalent);
  EXPECT_NEAR(test_equivalence(0.02, 0.03 / 1.644854, infinity, 0.05).p, 0.05, 1e-7);
}

TEST(Equivalence, OutsideTheBandNothingIsShown) {
  EXPECT_DOUBLE_EQ(test_equivalence(0.05, 0.01, 5.0, 0.05).p, 0.5);
  EXPECT_NEAR(test_equivalence(0.07, 0.01, 4.0, 0.05).p, 1.0 - 0.05805826, 1e-8);
  EXPECT_FALSE(test_equivalence(0.0, 10.0, 5.0, 0.05).equivalent);  // nor is it by scatter
}

TEST(Equivalence, WithoutUncertaintyTheBandDecides) {
  EXPECT_EQ(test_equivalence(0.049, 0.0, 5.0, 0.05).p, 0.0);
  EXPECT_TRUE(test_equivalence(-0.049, 0.0, 5.0, 0.05).equivalent);
  EXPECT_EQ(test_equivalence(0.05, 0.0, 5.0, 0.05).p, 1.0);
  EXPECT_FALSE(test_equivalence(0.05, 0.0, 5.0, 0.05).equivalent);
}

TEST(Equivalence, IsWronglyShownAsRarelyAsItsLevelSays) {
  constexpr double band = 1.0, sigma = 0.3;
  constexpr int trials = 4000, runs = 5;
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal(band, sigma);  // just not equivalent
  int shown = 0;
  for (int trial = 0; trial < trials; ++trial) {
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < runs; ++i) {
      const double value = normal(random);
      sum += value;
      squares += value * value;
    }
    const double mean = sum / runs, deviation = std::sqrt((squares - runs * mean * mean) / (runs - 1));
    shown += test_equivalence(mean, deviation / std::sqrt(runs), runs - 1, band).equivalent;
  }
  EXPECT_NEAR(shown, 0.05 * trials, 3.0 * std::sqrt(0.05 * 0.95 * trials));
}

TEST(Equivalence, RefusesNumbersThatMeanNothing) {
  EXPECT_THROW(test_equivalence(NAN, 0.01, 5.0, 0.05), std::invalid_argument);
  EXPECT_THROW(test_equivalence(0.0, -0.01, 5.0, 0.05), std::invalid_argument);
  EXPECT_THROW(test_equivalence(0.0, NAN, 5.0, 0.05), std::invalid_argument);
  EXPECT_THROW(test_equivalence(0.0, 0.01, 0.0, 0.05), std::invalid_argument);
  EXPECT_THROW(test_equivalence(0.0, 0.01, 5.0, 0.0), std::invalid_argument);
  EXPECT_THROW(test_equivalence(0.0, 0.01, 5.0, 0.05, 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace talus::analysis
