// Longer or not, as the eigenvalues have it.
#include "continuum/particles/semi_axis.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <random>

namespace talus {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST(IsLonger, AgreesWithTheEigenvaluesHoweverNear) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int longer = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Eigen::Quaterniond turn(unit(random), unit(random), unit(random), 1.5 + unit(random));
    const Matrix3d axes = turn.normalized().toRotationMatrix();
    // The longest differs from the bound by 1 part in 10 to 10^12.
    const double longest = 0.02,
                 apart = std::copysign(std::pow(10.0, 5.5 * unit(random) - 6.5), unit(random));
    Vector3d lengths(longest * (1.0 + apart), 0.02 * std::abs(unit(random)), 0.02 * std::abs(unit(random)));
    if (trial % 7 == 0) lengths[1] = 3.0 * longest;
    if (trial % 14 == 0) lengths[2] = 4.0 * longest;  // and more than one longer
    const Matrix3d shape = axes * lengths.cwiseProduct(lengths).asDiagonal() * axes.transpose();
    EXPECT_EQ(is_longer(shape, longest), lengths.maxCoeff() > longest) << lengths.transpose();
    longer += lengths.maxCoeff() > longest;
  }
  EXPECT_GT(longer, 5000);
  EXPECT_LT(longer, 15000);
}

TEST(IsLonger, IsFalseForWhatIsNotFinite) {
  Matrix3d shape = Matrix3d::Identity();
  shape(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(is_longer(shape, 0.1));
  shape(1, 1) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(is_longer(shape, 0.1));
}

}  // namespace
}  // namespace talus
