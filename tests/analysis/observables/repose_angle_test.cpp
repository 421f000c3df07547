// The angle ruler on heaps of random points whose angle is known.
#include "analysis/observables/repose_angle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <stdexcept>

namespace talus::analysis {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double angle = 28.0 * degree;
constexpr double length = 0.1;       // m, of the heap's foot
constexpr double thickness = 0.012;  // m
constexpr double grain = 0.002;      // m, size of the items
constexpr double packing = 0.58;
const Eigen::Vector2d axis(0.3, -0.2);

/// Points at random, one in each small cube of the given side, wherever it lies under h(x, y) in the box [low, high]: as even
/// as a packing of grains of that size, where wholly random points would be ten times as uneven.
Snapshot heap(double side, unsigned seed, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
              const std::function<double(double, double)>& surface) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Eigen::Array3i cubes = ((high - low) / side).array().round().cast<int>();
  const Eigen::Array3d edges = (high - low).array() / cubes.cast<double>();
  std::vector<Eigen::Vector3d> points;
  for (int cube = 0; cube < cubes.prod(); ++cube) {
    const Eigen::Array3d corner(cube % cubes.x(), cube / cubes.x() % cubes.y(),
                                cube / (cubes.x() * cubes.y()));
    const Eigen::Array3d share(uniform(generator), uniform(generator), uniform(generator));
    const Eigen::Vector3d point = low.array() + (corner + share) * edges;
    if (point.z() < surface(point.x(), point.y())) points.push_back(point);
  }
  const auto items = static_cast<Eigen::Index>(points.size());
  return {1.0, Eigen::Map<const Vectors>(points.front().data(), 3, items), Vectors::Zero(3, items),
          Eigen::VectorXd::Constant(items, packing * edges.prod())};
}

Snapshot wedge(double side, unsigned seed) {
  return heap(side, seed, {0.0, 0.0, 0.0}, {length, thickness, length * std::tan(angle)},
              [](double x, double) { return (length - x) * std::tan(angle); });
}

Snapshot cone(double side, unsigned seed) {
  const Eigen::Vector3d centre(axis.x(), axis.y(), 0.0);
  return heap(side, seed, centre + Eigen::Vector3d(-length, -length, 0.0),
              centre + Eigen::Vector3d(length, length, length * std::tan(angle)), [](double x, double y) {
                return (length - std::hypot(x - axis.x(), y - axis.y())) * std::tan(angle);
              });
}

const ReposeRuler planar{.shape = PlanarSlope{0.0, 1.0, 0.0, thickness}, .bin_width = 0.004, .sectors = 4};
const ReposeRuler conical{.shape = ConicalHeap{axis}, .bin_width = 0.004};

double degrees(double radians) { return radians / degree; }

TEST(ReposeAngle, Wedge) {
  const auto measured = measure_repose_angle(wedge(grain, 1), planar);
  EXPECT_NEAR(degrees(measured.angle), 28.0, 0.5);
  EXPECT_NEAR(measured.volume_fraction, packing, 0.01 * packing);
  EXPECT_NEAR(measured.crest_height, length * std::tan(angle), 0.05 * length);
  EXPECT_NEAR(measured.flank_begin, 0.2 * length, 2.0 * planar.bin_width);
  EXPECT_NEAR(measured.flank_end, 0.8 * length, 2.0 * planar.bin_width);
  EXPECT_LT(degrees(measured.fit_standard_error), 1.0);
  ASSERT_EQ(measured.sector_angles.size(), 4u);
  for (const double sector : measured.sector_angles) EXPECT_NEAR(degrees(sector), 28.0, 2.0);
  EXPECT_GT(measured.sector_deviation, 0.0);
}

TEST(ReposeAngle, WedgeThatFallsTheOtherWayOnAHighFloor) {
  Snapshot snapshot = wedge(grain, 2);
  snapshot.positions.row(0) = 0.5 - snapshot.positions.row(0).array();
  snapshot.positions.row(2).array() += 0.3;
  ReposeRuler ruler = planar;
  ruler.shape = PlanarSlope{0.5, -1.0, 0.0, thickness};
  ruler.floor_height = 0.3;
  EXPECT_NEAR(degrees(measure_repose_angle(snapshot, ruler).angle), 28.0, 0.5);
}

TEST(ReposeAngle, Cone) {
  const auto measured = measure_repose_angle(cone(grain, 3), conical);
  EXPECT_NEAR(degrees(measured.angle), 28.0, 0.5);
  EXPECT_NEAR(measured.volume_fraction, packing, 0.01 * packing);
  ASSERT_EQ(measured.sector_angles.size(), 8u);
  double mean = 0.0;
  for (const double sector : measured.sector_angles) mean += degrees(sector) / 8.0;
  EXPECT_NEAR(mean, 28.0, 3.0 * degrees(measured.sector_deviation) / std::sqrt(8.0));
  EXPECT_LT(degrees(measured.sector_deviation), 2.0);
}

TEST(ReposeAngle, TheSizeOfItemsDoesNotMatter) {
  for (const double side : {0.004, 0.002, 0.001}) {
    EXPECT_NEAR(degrees(measure_repose_angle(wedge(0.5 * side, 6), planar).angle), 28.0, 0.5) << side;
    EXPECT_NEAR(degrees(measure_repose_angle(cone(side, 7), conical).angle), 28.0, 0.5) << side;
  }
}

TEST(ReposeAngle, FineItemsShowNoBias) {
  EXPECT_NEAR(degrees(measure_repose_angle(wedge(0.0005, 4), planar).angle), 28.0, 0.05);
  EXPECT_NEAR(degrees(measure_repose_angle(cone(0.001, 5), conical).angle), 28.0, 0.05);
}

TEST(ReposeAngle, TheScatterOfTheSectorsIsThatOfHeaps) {
  constexpr int trials = 60;
  double squared_deviation = 0.0, squared_sectors = 0.0;
  for (unsigned trial = 0; trial < trials; ++trial) {
    const auto measured = measure_repose_angle(cone(0.004, 100 + trial), conical);
    squared_deviation += std::pow(measured.angle - angle, 2) / trials;
    squared_sectors += std::pow(measured.sector_deviation, 2) / 8.0 / trials;
  }
  // One more item in a bin or sector is one fewer beside it, so sectors scatter a little more than their mean tells.
  EXPECT_NEAR(std::sqrt(squared_sectors / squared_deviation), 1.2, 0.3);
}

TEST(ReposeAngle, ALopsidedConeShowsInTheSectors) {
  // One half stands 6 degrees steeper than the other.
  const auto surface = [](double x, double y) {
    const double here = x > axis.x() ? 25.0 * degree : 31.0 * degree;
    return 0.05 - std::hypot(x - axis.x(), y - axis.y()) * std::tan(here);
  };
  const Snapshot lopsided = heap(grain, 8, {axis.x() - 0.12, axis.y() - 0.12, 0.0},
                                 {axis.x() + 0.12, axis.y() + 0.12, 0.05}, surface);
  const auto measured = measure_repose_angle(lopsided, conical);
  // Two groups of four, 3 degrees to either side: sqrt(8/7) x 3.
  EXPECT_NEAR(degrees(measured.sector_deviation), std::sqrt(8.0 / 7.0) * 3.0, 0.7);
  // Its own packing reads too low, as the mean of the squared heights is more than the square of their mean.
  EXPECT_NEAR(degrees(measured.angle), 28.0, 1.5);
}

void append(Snapshot& snapshot, const Eigen::Vector3d& position, double volume) {
  const auto last = snapshot.volumes.size();
  snapshot.positions.conservativeResize(3, last + 1);
  snapshot.velocities.conservativeResize(3, last + 1);
  snapshot.volumes.conservativeResize(last + 1);
  snapshot.positions.col(last) = position;
  snapshot.velocities.col(last).setZero();
  snapshot.volumes[last] = volume;
}

TEST(ReposeAngle, OutliersDoNotTurnIt) {
  Snapshot snapshot = wedge(grain, 9);
  const double before = measure_repose_angle(snapshot, planar).angle;
  const double bin_depth = planar.bin_width * thickness * packing;
  // A clod on the flank a fifth of the heap high, and grains that rolled far away.
  append(snapshot, {0.07, 0.5 * thickness, 0.02}, 0.01 * bin_depth);
  append(snapshot, {3.0 * length, 0.5 * thickness, 0.001}, 0.002 * bin_depth);
  append(snapshot, {5.0 * length, 0.5 * thickness, 0.001}, 0.002 * bin_depth);
  EXPECT_NEAR(degrees(measure_repose_angle(snapshot, planar).angle), degrees(before), 0.3);
}

TEST(ReposeAngle, WhatFellOverTheEdgeDoesNotCount) {
  // A slope that goes on below the edge of the ledge at 0.06 m, where 0.04 tan(28) of it still stands.
  Snapshot snapshot = heap(grain, 10, {0.0, 0.0, 0.0}, {0.06, thickness, length * std::tan(angle)},
                           [](double x, double) { return (length - x) * std::tan(angle); });
  ReposeRuler ruler = planar;
  ruler.reach = 0.06;
  ruler.volume_fraction = packing;
  EXPECT_NEAR(degrees(measure_repose_angle(snapshot, ruler).angle), 28.0, 0.5);
  const double before = measure_repose_angle(snapshot, ruler).angle;
  for (int k = 0; k < 100; ++k) append(snapshot, {0.062 + 0.001 * k, 0.001, -0.1 + 0.01 * k}, 1e-7);
  append(snapshot, {0.03, 0.001, -0.01}, 1e-5);  // under the ledge
  EXPECT_DOUBLE_EQ(measure_repose_angle(snapshot, ruler).angle, before);
}

TEST(ReposeAngle, GivenPackingIsUsed) {
  ReposeRuler ruler = planar;
  ruler.volume_fraction = 0.5 * packing;
  const auto measured = measure_repose_angle(wedge(grain, 11), ruler);
  EXPECT_EQ(measured.volume_fraction, 0.5 * packing);
  EXPECT_NEAR(std::tan(measured.angle), 2.0 * std::tan(angle), 0.04);
}

TEST(ReposeAngle, HeapsThatHaveNoAngle) {
  const Snapshot nothing{1.0, Vectors(3, 0), Vectors(3, 0), Eigen::VectorXd(0)};
  EXPECT_THROW(measure_repose_angle(nothing, planar), SnapshotError);
  ReposeRuler coarse = planar;
  coarse.bin_width = 0.2 * length;
  EXPECT_THROW(measure_repose_angle(wedge(grain, 12), coarse), SnapshotError);
  const Snapshot block =
      heap(grain, 13, {0.0, 0.0, 0.0}, {length, thickness, 0.05}, [](double, double) { return 1.0; });
  EXPECT_THROW(measure_repose_angle(block, planar), SnapshotError);
}

TEST(ReposeAngle, BrokenRulers) {
  const Snapshot snapshot = wedge(grain, 14);
  const auto expect_refused = [&](auto&& spoil) {
    ReposeRuler broken = planar;
    spoil(broken);
    EXPECT_THROW(measure_repose_angle(snapshot, broken), std::invalid_argument);
  };
  expect_refused([](ReposeRuler& broken) { broken.bin_width = 0.0; });
  expect_refused([](ReposeRuler& broken) { broken.reach = -1.0; });
  expect_refused([](ReposeRuler& broken) { broken.volume_fraction = 1.2; });
  expect_refused([](ReposeRuler& broken) { broken.sectors = 1; });
  expect_refused([](ReposeRuler& broken) { broken.shape = PlanarSlope{0.0, 0.5, 0.0, thickness}; });
  expect_refused([](ReposeRuler& broken) { broken.shape = PlanarSlope{0.0, 1.0, 0.0, 0.0}; });
}

}  // namespace
}  // namespace talus::analysis
