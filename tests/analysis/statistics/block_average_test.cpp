// Block averages against series whose error is known: x_k+1 = r x_k + noise has the error s sqrt((1 + r) / (1 - r) / n).
#include "analysis/statistics/block_average.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "analysis/statistics/fit_error.h"

namespace talus::analysis {
namespace {

/// Mean 3, standard deviation 1, correlation r from one sample to the next.
std::vector<double> series(std::size_t count, double r, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<double> samples;
  double deviation = normal(generator);
  for (std::size_t k = 0; k < count; ++k) {
    samples.push_back(3.0 + deviation);
    deviation = r * deviation + std::sqrt(1.0 - r * r) * normal(generator);
  }
  return samples;
}

struct Ratio {
  double stated_error;  // root mean square, over the known
  double deviation;     // root mean square of the means' errors, over the known error
  double effective;     // mean effective number, over the known
  int flat;
};

Ratio over_series(std::size_t count, double r, int trials) {
  const double known = std::sqrt((1.0 + r) / (1.0 - r) / static_cast<double>(count));
  Ratio ratio{};
  for (int trial = 0; trial < trials; ++trial) {
    const auto average = block_average(series(count, r, 100 + static_cast<unsigned>(trial)));
    ratio.stated_error += std::pow(average.standard_error / known, 2) / trials;
    ratio.deviation += std::pow((average.mean - 3.0) / known, 2) / trials;
    ratio.effective += average.effective_number * known * known / trials;
    ratio.flat += average.flat ? 1 : 0;
  }
  ratio.stated_error = std::sqrt(ratio.stated_error);
  ratio.deviation = std::sqrt(ratio.deviation);
  return ratio;
}

TEST(BlockAverage, IndependentSamples) {
  const auto ratio = over_series(2000, 0.0, 100);
  EXPECT_NEAR(ratio.stated_error, 1.0, 0.03);
  EXPECT_NEAR(ratio.effective, 1.0, 0.1);
  EXPECT_NEAR(ratio.deviation, 1.0, 0.25);
  EXPECT_EQ(ratio.flat, 100);
}

TEST(BlockAverage, CorrelatedSamples) {
  const auto ratio = over_series(20000, 0.9, 100);  // 19 samples count as one
  EXPECT_NEAR(ratio.stated_error, 1.0, 0.05);
  EXPECT_NEAR(ratio.effective, 1.0, 0.15);
  EXPECT_NEAR(ratio.deviation, 1.0, 0.25);
  EXPECT_EQ(ratio.flat, 100);
}

TEST(BlockAverage, SamplesThatTakeTurnsKnowTheirMeanBetter) {
  EXPECT_NEAR(over_series(20000, -0.5, 100).stated_error, 1.0, 0.05);
}

TEST(BlockAverage, TooShortASeriesSaysSo) {
  const auto ratio = over_series(300, 0.99, 100);  // 199 samples count as one
  EXPECT_LE(ratio.flat, 2);
  EXPECT_LT(ratio.stated_error, 0.8);
  EXPECT_GT(ratio.stated_error, 0.2);  // the naive error would be 0.07
  EXPECT_FALSE(block_average(std::vector{1.0, 2.0}).flat);
}

TEST(BlockAverage, TheMeanIsOfAllSamples) {
  const std::vector<double> odd{1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 700.0};
  EXPECT_DOUBLE_EQ(block_average(odd).mean, 103.0);
}

TEST(BlockAverage, ConstantSeries) {
  const auto average = block_average(std::vector<double>(10, 4.0));
  EXPECT_EQ(average.mean, 4.0);
  EXPECT_EQ(average.standard_error, 0.0);
  EXPECT_EQ(average.effective_number, 10.0);
  EXPECT_TRUE(average.flat);
}

TEST(BlockAverage, NoSeries) {
  EXPECT_THROW(block_average({}), FitError);
  EXPECT_THROW(block_average(std::vector{1.0}), FitError);
  EXPECT_THROW(block_average(std::vector<double>{1.0, NAN}), FitError);
}

}  // namespace
}  // namespace talus::analysis
