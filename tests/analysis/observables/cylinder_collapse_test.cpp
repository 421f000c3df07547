// The cylinder's ruler on round deposits whose every figure is known in closed form.
#include "analysis/observables/cylinder_collapse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <random>
#include <stdexcept>

namespace talus::analysis {
namespace {

constexpr double radius = 0.05;  // m
constexpr double height = 0.04;  // m
constexpr double packing = 0.58;
constexpr double bin = 0.0025;  // m
const CylinderRuler ruler{.axis = {0.3, -0.1}, .radius = radius, .bin_width = bin, .front_depth = 0.002};

/// A deposit of the depth h(r, angle) within reach(angle), in 800 circles of 16 spokes of two layers.
Snapshot deposit(double time, const std::function<double(double)>& reach,
                 const std::function<double(double, double)>& depth) {
  constexpr int circles = 800, spokes = 16, layers = 2;
  Snapshot snapshot{time, Vectors(3, circles * spokes * layers), Vectors::Zero(3, circles * spokes * layers),
                    Eigen::VectorXd(circles * spokes * layers)};
  int item = 0;
  for (int circle = 0; circle < circles; ++circle) {
    for (int spoke = 0; spoke < spokes; ++spoke) {
      const double angle = 2.0 * std::numbers::pi * (spoke + 0.5) / spokes;
      const double r = reach(angle) * (circle + 0.5) / circles;
      const double area = 2.0 * std::numbers::pi / spokes * r * reach(angle) / circles;
      for (int layer = 0; layer < layers; ++layer, ++item) {
        snapshot.positions.col(item) << ruler.axis.x() + r * std::cos(angle),
            ruler.axis.y() + r * std::sin(angle), (layer + 0.5) / layers * depth(r, angle);
        snapshot.volumes[item] = packing * area * depth(r, angle) / layers;
      }
    }
  }
  return snapshot;
}

Snapshot cylinder(double time) {
  return deposit(
      time, [](double) { return radius; }, [](double, double) { return height; });
}

/// A cone of the cylinder's volume: at twice the radius it is 3/4 as high.
constexpr double cone_reach = 2.0 * radius;
constexpr double cone_height = 0.75 * height;
Snapshot cone(double time) {
  return deposit(
      time, [](double) { return cone_reach; },
      [](double r, double) { return cone_height * (1.0 - r / cone_reach); });
}

TEST(CylinderCollapse, ReleasedCylinder) {
  const auto measured = measure_cylinder_collapse({cylinder(0.0), cylinder(0.1)}, ruler).observables;
  EXPECT_NEAR(measured.settled_height, height / radius, 1e-9);
  EXPECT_NEAR(measured.settled_volume_fraction, packing, 1e-9);
  EXPECT_NEAR(measured.r90, std::sqrt(0.90), 1e-3);
  EXPECT_NEAR(measured.r95, std::sqrt(0.95), 1e-3);
  EXPECT_NEAR(measured.mean_radius, 2.0 / 3.0, 1e-6);
  EXPECT_NEAR(measured.final_height, height / radius, 1e-3);
  EXPECT_NEAR(measured.runout, 0.0, 1.5 * bin / radius);
  EXPECT_NEAR(measured.roundness, 0.0, 1e-9);
  EXPECT_NEAR(measured.drift, 0.0, 1e-12);
  EXPECT_NEAR(measured.lost_volume, 0.0, 1e-12);
  EXPECT_TRUE(measured.at_rest);
}

TEST(CylinderCollapse, Cone) {
  const auto measured = measure_cylinder_collapse({cylinder(0.0), cone(1.0)}, ruler);
  const auto& observables = measured.observables;
  const double reach = cone_reach / radius;
  EXPECT_NEAR(observables.runout, reach * (1.0 - ruler.front_depth / cone_height) - 1.0, 1e-3);
  EXPECT_NEAR(observables.mean_radius, reach / 2.0, 1e-5);
  // Within r lies the share 3 s^2 - 2 s^3 of the volume, s = r over the reach.
  const double s90 = observables.r90 / reach, s95 = observables.r95 / reach;
  EXPECT_NEAR(3.0 * s90 * s90 - 2.0 * std::pow(s90, 3), 0.90, 1e-3);
  EXPECT_NEAR(3.0 * s95 * s95 - 2.0 * std::pow(s95, 3), 0.95, 1e-3);
  EXPECT_NEAR(observables.lost_volume, 0.0, 1e-5);
  // The innermost ring reads the cone at 10/13 of a bin.
  EXPECT_NEAR(observables.final_height, cone_height * (1.0 - 10.0 / 13.0 * bin / cone_reach) / radius, 1e-3);
  for (std::size_t k = 0; measured.final_profile.x[k] < cone_reach - 1.5 * bin; ++k) {
    const double r = measured.final_profile.x[k];
    EXPECT_NEAR(measured.final_profile.depth[k], cone_height * (1.0 - r / cone_reach), 2e-5) << k;
  }
}

TEST(CylinderCollapse, AnEllipseIsNotRound) {
  // The mean of 0.1 cos(2 angle) over an eighth is 0.1 x 2 / pi, by turns positive and negative.
  const auto reach = [](double angle) { return cone_reach * (1.0 + 0.1 * std::cos(2.0 * angle)); };
  const Snapshot ellipse =
      deposit(1.0, reach, [&](double r, double angle) { return cone_height * (1.0 - r / reach(angle)); });
  const auto measured = measure_cylinder_collapse({cylinder(0.0), ellipse}, ruler).observables;
  EXPECT_NEAR(measured.roundness, 0.1 * 2.0 / std::numbers::pi * std::sqrt(8.0 / 7.0), 0.01);
  EXPECT_NEAR(measured.drift, 0.0, 1e-12);
}

TEST(CylinderCollapse, DriftIsThatOfTheCentreOfMass) {
  Snapshot moved = cone(1.0);
  moved.positions.row(0).array() += 0.03 * radius;
  moved.positions.row(1).array() -= 0.04 * radius;
  const auto measured = measure_cylinder_collapse({cylinder(0.0), moved}, ruler).observables;
  EXPECT_NEAR(measured.drift, 0.05, 1e-9);
}

/// The radii grow as 1 - exp(-t / tau).
SnapshotSeries spreading(double end_time, double tau) {
  SnapshotSeries series;
  const Snapshot start = cylinder(0.0);
  for (int k = 0; k <= 100; ++k) {
    Snapshot snapshot = start;
    snapshot.time = end_time * k / 100;
    const double growth = 1.0 + 0.5 * (1.0 - std::exp(-snapshot.time / tau));
    snapshot.positions.topRows<2>() =
        ((snapshot.positions.topRows<2>().colwise() - ruler.axis) * growth).colwise() + ruler.axis;
    series.push_back(std::move(snapshot));
  }
  return series;
}

TEST(CylinderCollapse, StopTimeOfADecayingMotion) {
  const auto measured = measure_cylinder_collapse(spreading(1.0, 0.1), ruler);
  const double end = std::exp(-10.0);
  EXPECT_NEAR(measured.observables.stop_time, -0.1 * std::log(end + 0.01 * (1.0 - end)), 0.003);
  EXPECT_TRUE(measured.observables.at_rest);
  EXPECT_EQ(measured.curves.time.size(), 101u);
  EXPECT_NEAR(measured.curves.mean_radius.back(), 2.0 / 3.0 * 1.5 * radius, 1e-4);
  EXPECT_FALSE(measure_cylinder_collapse(spreading(0.2, 0.1), ruler).observables.at_rest);
}

TEST(CylinderCollapse, NeitherOrderNorSplittingMatters) {
  const Snapshot end = cone(1.0);
  std::vector<Eigen::Index> order(static_cast<std::size_t>(end.volumes.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(12345));
  Snapshot split{end.time, Vectors(3, 2 * end.volumes.size()), Vectors::Zero(3, 2 * end.volumes.size()),
                 Eigen::VectorXd(2 * end.volumes.size())};
  split.positions << end.positions(Eigen::all, order), end.positions;
  split.volumes << 0.25 * end.volumes(order), 0.75 * end.volumes;
  const auto before = measure_cylinder_collapse({cylinder(0.0), end}, ruler).observables;
  const auto after = measure_cylinder_collapse({cylinder(0.0), split}, ruler).observables;
  EXPECT_NEAR(after.runout, before.runout, 1e-9);
  EXPECT_NEAR(after.r90, before.r90, 1e-9);
  EXPECT_NEAR(after.mean_radius, before.mean_radius, 1e-9);
  EXPECT_NEAR(after.roundness, before.roundness, 1e-9);
}

TEST(CylinderCollapse, SeriesThatCannotBeMeasured) {
  EXPECT_THROW(measure_cylinder_collapse({}, ruler), SnapshotError);
  EXPECT_THROW(measure_cylinder_collapse({cylinder(0.5)}, ruler), SnapshotError);
  const Snapshot nothing{1.0, Vectors(3, 0), Vectors(3, 0), Eigen::VectorXd(0)};
  EXPECT_THROW(measure_cylinder_collapse({cylinder(0.0), nothing}, ruler), SnapshotError);
  Snapshot escaped = cone(1.0);
  escaped.positions(0, 0) = 1e9;
  EXPECT_THROW(measure_cylinder_collapse({cylinder(0.0), escaped}, ruler), SnapshotError);
  CylinderRuler broken = ruler;
  broken.bin_width = 0.0;
  EXPECT_THROW(measure_cylinder_collapse({cylinder(0.0)}, broken), std::invalid_argument);
}

}  // namespace
}  // namespace talus::analysis
