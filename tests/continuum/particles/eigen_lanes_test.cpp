// Jacobi's rotations against Eigen's own solver.
#include "continuum/particles/eigen_lanes.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <random>

#include "tests/continuum/particles/particle_sums.h"

namespace talus {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d matrix_in(const SymmetricLanes& m, int lane) {
  Matrix3d matrix;
  matrix << m[0][lane], m[5][lane], m[4][lane], m[5][lane], m[1][lane], m[3][lane], m[4][lane], m[3][lane],
      m[2][lane];
  return matrix;
}

void set_lane(const Matrix3d& s, int lane, SymmetricLanes& m) {
  const std::array<double, 6> entries{s(0, 0), s(1, 1), s(2, 2), s(1, 2), s(2, 0), s(0, 1)};
  for (std::size_t k = 0; k < 6; ++k) m[k][lane] = entries[k];
}

void expect_decomposed(const SymmetricLanes& matrices) {
  const EigenLanes eigen = eigen_of(matrices);
  const SymmetricLanes again = matrix_of(eigen);
  for (int lane = 0; lane < lane_count; ++lane) {
    const Matrix3d matrix = matrix_in(matrices, lane);
    EXPECT_LT((matrix_in(again, lane) - matrix).norm(), 1e-13 * matrix.norm());
    Vector3d values(eigen.values[0][lane], eigen.values[1][lane], eigen.values[2][lane]);
    std::sort(values.begin(), values.end());
    EXPECT_LT((values - Eigen::SelfAdjointEigenSolver<Matrix3d>(matrix).eigenvalues()).norm(), 1e-14);
    Matrix3d vectors;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < 3; ++i)
        vectors(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = eigen.vectors[k][i][lane];
    EXPECT_LT((vectors.transpose() * vectors - Matrix3d::Identity()).norm(), 1e-14);
  }
}

TEST(EigenLanes, DecomposeRandomMatricesOfAnyAspect) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int trial = 0; trial < 2000; ++trial) {
    SymmetricLanes matrices;
    for (int lane = 0; lane < lane_count; ++lane) {
      const Eigen::Quaterniond turn(unit(random), unit(random), unit(random), 1.5 + unit(random));
      const Matrix3d axes = turn.normalized().toRotationMatrix();
      Vector3d squares(1.0, std::pow(10.0, 4.0 * unit(random) - 4.0),
                       std::pow(10.0, 4.0 * unit(random) - 4.0));
      if (trial % 5 == 0) squares[1] = squares[lane % 2 ? 0 : 2];  // two the same
      const Matrix3d matrix = axes * squares.asDiagonal() * axes.transpose();
      set_lane(matrix / matrix.trace(), lane, matrices);
    }
    expect_decomposed(matrices);
  }
}

TEST(EigenLanes, DecomposeDiagonalEqualAndFlatMatrices) {
  SymmetricLanes matrices;
  set_lane(Matrix3d::Identity() / 3.0, 0, matrices);
  set_lane(testing::ellipsoid(0.0, 1.0, 0.0), 1, matrices);
  set_lane(Matrix3d::Constant(1.0 / 3.0), 2, matrices);
  Matrix3d twin = testing::ellipsoid(0.5, 0.5, std::sqrt(0.5));
  twin(0, 1) = twin(1, 0) = 0.2;
  set_lane(twin, 3, matrices);
  expect_decomposed(matrices);
}

}  // namespace
}  // namespace talus
