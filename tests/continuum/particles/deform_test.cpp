// Equation 5.42: ellipsoids follow known flows, and stay ellipsoids in any other.
#include "continuum/particles/deform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/continuum/particles/particle_sums.h"

namespace talus {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::ellipsoid;
using Gradients = Eigen::Matrix<double, 9, Eigen::Dynamic>;

constexpr double h = 0.1;
const std::vector<Material> materials{{"sand", 2500.0, 0.6, 0.5}};
const double full = 1500.0 * h * h * h;

/// One particle, so light that only the flow changes it.
Particles light_particle(const Matrix3d& shape) {
  Particles particles;
  testing::add_particle({0.0, 0.0, 0.0}, 1e-6 * full, shape, particles);
  return particles;
}

Matrix3d deformed(const Matrix3d& shape, const Matrix3d& gradient, double time, int steps) {
  Particles particles = light_particle(shape);
  for (int k = 0; k < steps; ++k) {
    const DeformReport report = deform(gradient.reshaped(), time / steps, materials, h, particles);
    EXPECT_EQ(report.thickened + report.enlarged + report.reduced + report.not_finite, 0);
  }
  return shape_matrix(particles, 0);
}

TEST(Deform, NoFlowLeavesShapesAsTheyAre) {
  const Matrix3d shape = ellipsoid(0.03, 0.02, 0.01);
  EXPECT_EQ(deformed(shape, Matrix3d::Zero(), 1.0, 3), shape);
}

TEST(Deform, SimpleShearGivesTheAnalyticEllipsoidInAnyNumberOfSteps) {
  const Matrix3d shape = ellipsoid(0.03, 0.02, 0.015);
  Matrix3d gradient = Matrix3d::Zero();
  gradient(0, 2) = 1.7;  // d v_x / d z
  Matrix3d expected = shape;
  expected(0, 0) += 1.7 * 1.7 * shape(2, 2);
  expected(0, 2) = expected(2, 0) = 1.7 * shape(2, 2);
  for (const int steps : {1, 10, 1000})
    EXPECT_LT((deformed(shape, gradient, 1.0, steps) - expected).norm(), 1e-12 * expected.norm());
}

TEST(Deform, StretchingConvergesToTheAnalyticEllipsoidAtFirstOrder) {
  // Exact: S_ij e^{(k_i + k_j) t}, turned with the axes of the flow.
  const Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3d(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  const Vector3d rates(0.8, -0.3, -0.5);
  const Matrix3d gradient = turn * rates.asDiagonal() * turn.transpose();
  const Matrix3d shape = ellipsoid(0.03, 0.02, 0.015);
  const Vector3d growth = rates.array().exp();
  const Matrix3d flow = turn * growth.asDiagonal() * turn.transpose();
  const Matrix3d expected = flow * shape * flow.transpose();
  double previous = 0.0;
  for (const int steps : {16, 32, 64, 128}) {
    const double error = (deformed(shape, gradient, 1.0, steps) - expected).norm() / expected.norm();
    if (previous > 0.0) {
      EXPECT_NEAR(std::log2(previous / error), 1.0, 0.05) << steps;
    }
    previous = error;
  }
  EXPECT_LT(previous, 0.01);
}

TEST(Deform, RigidRotationKeepsTheSemiAxesToSecondOrderInAStep) {
  const Matrix3d shape = ellipsoid(0.03, 0.02, 0.015);
  Matrix3d spin;
  spin << 0.0, -0.4, 0.3, 0.4, 0.0, -0.8, -0.3, 0.8, 0.0;
  const auto error = [&](double dt) {
    const Vector3d axes = Eigen::SelfAdjointEigenSolver<Matrix3d>(deformed(shape, spin, dt, 1)).eigenvalues();
    const Vector3d before(0.015 * 0.015, 0.02 * 0.02, 0.03 * 0.03);
    return (axes - before).norm() / before.norm();
  };
  EXPECT_NEAR(std::log2(error(0.02) / error(0.01)), 2.0, 0.02);
  EXPECT_LT(error(0.01), 1e-4);
}

TEST(Deform, VolumeIsAtLeastThatOfThePackedSandAndAtMostACell) {
  Particles particles;
  testing::add_particle(Vector3d::Zero(), full / 8.0, ellipsoid(0.01, 0.01, 0.01), particles);
  testing::add_particle(Vector3d::Zero(), full / 8.0, ellipsoid(0.2, 0.1, 0.05), particles);
  testing::add_particle(Vector3d::Zero(), full / 8.0, ellipsoid(0.04, 0.04, 0.04), particles);
  testing::add_particle(Vector3d::Zero(), 3.0 * full, ellipsoid(0.04, 0.04, 0.04), particles);
  const DeformReport report = deform(Gradients::Zero(9, 4), 0.1, materials, h, particles);
  EXPECT_EQ(report.enlarged, 2);
  EXPECT_EQ(report.reduced, 1);
  EXPECT_EQ(report.thickened, 0);
  const double cell = h * h * h;
  EXPECT_NEAR(shape_volume(shape_matrix(particles, 0)), cell / 8.0, 1e-12 * cell);
  EXPECT_NEAR(shape_volume(shape_matrix(particles, 1)), cell, 1e-12 * cell);
  EXPECT_EQ(shape_matrix(particles, 2), ellipsoid(0.04, 0.04, 0.04));
  EXPECT_NEAR(shape_volume(shape_matrix(particles, 3)), 3.0 * cell, 1e-12 * cell);
  // As a whole: the shape of the second is still 4 : 2 : 1.
  EXPECT_NEAR(std::sqrt(particles.shapes(0, 1) / particles.shapes(2, 1)), 4.0, 1e-12);
  // And what has met its bound is at it.
  const DeformReport again = deform(Gradients::Zero(9, 4), 0.1, materials, h, particles);
  EXPECT_EQ(again.enlarged + again.reduced, 0);
}

TEST(Deform, NoStepIsTooLargeForAnEllipsoid) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  Particles particles;
  for (int p = 0; p < 3000; ++p)
    testing::add_particle(Vector3d::Zero(), full / 8.0, ellipsoid(0.05, 0.03, 0.02), particles);
  DeformReport total;
  for (const double size : {1.0, 1e3, 1e8, 1e60, 1e150}) {
    Gradients gradients(9, 3000);
    for (double& v : gradients.reshaped()) v = size * normal(random);
    gradients.col(0) = -10.0 * Matrix3d::Identity().reshaped();  // I + dt L = 0
    const DeformReport report = deform(gradients, 0.1, materials, h, particles);
    total.thickened += report.thickened;
    EXPECT_EQ(report.not_finite, 0);
    for (Eigen::Index p = 0; p < particles.count(); ++p) {
      const Matrix3d shape = shape_matrix(particles, p);
      const Vector3d squares = Eigen::SelfAdjointEigenSolver<Matrix3d>(shape).eigenvalues();
      ASSERT_GT(squares[0], 0.0);
      ASSERT_LE(std::sqrt(squares[2] / squares[0]), largest_axis_ratio * (1.0 + 1e-9));
      ASSERT_GE(shape_volume(shape), h * h * h / 8.0 * (1.0 - 1e-9));
      ASSERT_LE(shape_volume(shape), h * h * h * (1.0 + 1e-9));
      ASSERT_LE(std::sqrt(squares[2]), 6.3 * h);
    }
  }
  EXPECT_GT(total.thickened, 3000);
}

TEST(Deform, WhatIsNotFiniteIsCountedAndLeavesTheShape) {
  Particles particles = light_particle(ellipsoid(0.03, 0.02, 0.01));
  const Particles before = particles;
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    const DeformReport report = deform(Gradients::Constant(9, 1, bad), 0.1, materials, h, particles);
    EXPECT_EQ(report.not_finite, 1);
    EXPECT_TRUE(testing::identical(particles, before));
  }
}

}  // namespace
}  // namespace talus
