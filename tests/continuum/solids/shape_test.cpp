// Every shape against its densely sampled surface, and what every signed distance obeys.
#include "continuum/solids/shape.h"

#include <gmock/gmock.h>
#include <rapidcheck.h>

#include <random>

#include "tests/continuum/solids/specimens.h"

namespace talus {
namespace {

Eigen::Vector3d random_point(std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-1.5, 1.5);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

/// A point on a lattice of 1 mm: it hits axes, edges and faces, and shrinks well.
Eigen::Vector3d arbitrary_point() {
  const auto coordinate = rc::gen::inRange(-2000, 2001);
  const double x = *coordinate, y = *coordinate, z = *coordinate;
  return 1e-3 * Eigen::Vector3d(x, y, z);
}

Eigen::Vector3d gradient(const Shape& shape, const Eigen::Vector3d& at) {
  constexpr double step = 1e-6;
  Eigen::Vector3d slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d aside = step * Eigen::Vector3d::Unit(axis);
    slope[axis] = (signed_distance(shape, at + aside) - signed_distance(shape, at - aside)) / (2.0 * step);
  }
  return slope;
}

class EveryShape : public ::testing::TestWithParam<testing::SpecimenMaker> {
 protected:
  const testing::Specimen specimen_ = GetParam().make();
  std::mt19937_64 random_{7};
};

TEST_P(EveryShape, HasTheDistanceOfTheNearestSample) {
  int inside = 0, outside = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d at = random_point(random_);
    const double distance = signed_distance(specimen_.shape, at), sampled = specimen_.surface.distance(at);
    EXPECT_LE(std::abs(distance), sampled + 1e-4 * specimen_.surface.gap) << at.transpose();
    EXPECT_GE(std::abs(distance), sampled - specimen_.surface.gap) << at.transpose();
    EXPECT_EQ(distance < 0.0, specimen_.inside(at)) << at.transpose() << ": " << distance;
    ++(distance < 0.0 ? inside : outside);
  }
  for (std::size_t i = 0; i < specimen_.surface.points.size(); i += 97) {
    const Eigen::Vector3d& at = specimen_.surface.points[i];
    EXPECT_NEAR(signed_distance(specimen_.shape, at), 0.0, 1e-4) << at.transpose();
    const Eigen::Vector3d near = at + 0.02 * random_point(random_);  // where the sign is decided
    const double distance = signed_distance(specimen_.shape, near);
    EXPECT_EQ(distance < 0.0, specimen_.inside(near)) << near.transpose() << ": " << distance;
    ++(distance < 0.0 ? inside : outside);
  }
  EXPECT_GT(inside, 20);
  EXPECT_GT(outside, 20);
}

TEST_P(EveryShape, FallsAsFastAsOneWalksToTheNearestSurfacePoint) {
  for (int i = 0; i < 1000; ++i) {  // the chance to meet the medial axis is nil
    const Eigen::Vector3d at = random_point(random_), slope = gradient(specimen_.shape, at);
    const double distance = signed_distance(specimen_.shape, at);
    EXPECT_NEAR(slope.norm(), 1.0, 1e-5) << at.transpose();
    EXPECT_NEAR(signed_distance(specimen_.shape, at - distance * slope), 0.0, 1e-5) << at.transpose();
  }
}

TEST_P(EveryShape, ChangesNoFasterThanOneMoves) {
  EXPECT_TRUE(rc::check([this] {
    const Eigen::Vector3d a = arbitrary_point(), b = arbitrary_point();
    const double change = signed_distance(specimen_.shape, a) - signed_distance(specimen_.shape, b);
    RC_ASSERT(std::abs(change) <= (a - b).norm() + 1e-12);
  }));
}

TEST_P(EveryShape, IsHeldByItsBounds) {
  const Eigen::AlignedBox3d box = bounds(specimen_.shape);
  if (specimen_.shape.hollow || std::holds_alternative<Plane>(specimen_.shape.geometry)) {
    EXPECT_TRUE((box.sizes().array() == std::numeric_limits<double>::infinity()).all());
    EXPECT_TRUE(box.contains(Eigen::Vector3d(1e9, -1e9, 1e9)));
    return;
  }
  Eigen::AlignedBox3d sampled;
  for (const Eigen::Vector3d& point : specimen_.surface.points) sampled.extend(point);
  EXPECT_TRUE((box.min().array() <= sampled.min().array() + 1e-7).all());
  EXPECT_TRUE((box.max().array() >= sampled.max().array() - 1e-7).all());
  EXPECT_LE((sampled.min() - box.min()).maxCoeff(), specimen_.surface.gap);
  EXPECT_LE((box.max() - sampled.max()).maxCoeff(), specimen_.surface.gap);
}

INSTANTIATE_TEST_SUITE_P(Solids, EveryShape, ::testing::ValuesIn(testing::specimens()),
                         [](const auto& tested) { return tested.param.name; });

TEST(Shape, DistancesKnownByHand) {
  const Shape plane{Plane{{0, 0, 1}, Eigen::Vector3d::UnitZ()}};
  EXPECT_DOUBLE_EQ(signed_distance(plane, {5, 6, 3}), 2.0);
  EXPECT_DOUBLE_EQ(signed_distance(plane, {5, 6, 0}), -1.0);
  const Shape box{Box{{1, 1, 1}, {1, 2, 3}}};
  EXPECT_DOUBLE_EQ(signed_distance(box, {5, 7, 4}), 5.0);  // from an edge: 3 and 4
  EXPECT_DOUBLE_EQ(signed_distance(box, {1, 1, 1}), -1.0);
  const Shape sphere{Sphere{{1, 0, 0}, 2.0}};
  EXPECT_DOUBLE_EQ(signed_distance(sphere, {1, 3, 4}), 3.0);
  EXPECT_DOUBLE_EQ(signed_distance(sphere, {1, 0, 0}), -2.0);
}

TEST(Shape, HollowIsAllTheRest) {
  const Shape filled{Sphere{{0, 0, 0}, 1.0}}, hollow{filled.geometry, true};
  EXPECT_DOUBLE_EQ(signed_distance(filled, {0, 0, 0.25}), -0.75);
  EXPECT_DOUBLE_EQ(signed_distance(hollow, {0, 0, 0.25}), 0.75);
  EXPECT_DOUBLE_EQ(signed_distance(hollow, {0, 0, 3.0}), -2.0);
}

}  // namespace
}  // namespace talus
