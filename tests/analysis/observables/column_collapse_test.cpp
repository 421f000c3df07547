// The ruler on deposits whose every figure is known in closed form.
#include "analysis/observables/column_collapse.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <stdexcept>

namespace talus::analysis {
namespace {

constexpr double length = 0.05;           // m
constexpr double height = 0.04;           // m
constexpr double thickness = 0.01;        // m
constexpr double volume_fraction = 0.58;  // of the column at release
constexpr double bin = 0.0025;            // m, 20 bins in the column
constexpr CollapseRuler ruler{
    .column_length = length, .thickness = thickness, .bin_width = bin, .front_depth = 0.002};

/// A deposit of the depth h(x) on [0, reach], made of columns much narrower than a bin, ten items high.
Snapshot deposit(double time, double reach, const std::function<double(double)>& depth) {
  constexpr int columns = 4000;
  constexpr int layers = 4;
  Snapshot snapshot{time, Vectors(3, columns * layers), Vectors::Zero(3, columns * layers),
                    Eigen::VectorXd(columns * layers)};
  const double width = reach / columns;
  for (int item = 0; item < columns * layers; ++item) {
    const double x = (item / layers + 0.5) * width;
    const double layer = depth(x) / layers;
    snapshot.positions.col(item) << x, 0.3 * thickness, (item % layers + 0.5) * layer;
    snapshot.volumes[item] = volume_fraction * width * thickness * layer;
  }
  return snapshot;
}

Snapshot block(double time) {
  return deposit(time, length, [](double) { return height; });
}

// The wedge has the volume of the block and twice its length, so it is as high at the wall.
constexpr double wedge_reach = 2.0 * length;
Snapshot wedge(double time) {
  return deposit(time, wedge_reach, [](double x) { return height * (1.0 - x / wedge_reach); });
}

Snapshot shifted(Snapshot snapshot, double time, double distance) {
  snapshot.time = time;
  snapshot.positions.row(0).array() += distance;
  return snapshot;
}

void add_item(Snapshot& snapshot, double x, double volume) {
  const auto last = snapshot.volumes.size();
  snapshot.positions.conservativeResize(3, last + 1);
  snapshot.velocities.conservativeResize(3, last + 1);
  snapshot.volumes.conservativeResize(last + 1);
  snapshot.positions.col(last) << x, 0.0, 0.001;
  snapshot.velocities.col(last).setZero();
  snapshot.volumes[last] = volume;
}

TEST(ColumnCollapse, ReleasedBlock) {
  const auto measured = measure_column_collapse({block(0.0), block(0.1)}, ruler).observables;
  EXPECT_NEAR(measured.settled_height, height / length, 1e-9);
  EXPECT_NEAR(measured.settled_volume_fraction, volume_fraction, 1e-9);
  EXPECT_NEAR(measured.final_height, height / length, 1e-3);
  EXPECT_NEAR(measured.x90, 0.90, 1e-4);
  EXPECT_NEAR(measured.x95, 0.95, 1e-4);
  EXPECT_NEAR(measured.centre_of_mass, 0.5, 1e-9);
  EXPECT_NEAR(measured.runout, 0.0, 1.5 * bin / length);
  EXPECT_NEAR(measured.lost_volume, 0.0, 1e-12);
  EXPECT_DOUBLE_EQ(measured.stop_time, 0.0);
  EXPECT_TRUE(measured.at_rest);
}

TEST(ColumnCollapse, BlockProfileIsFlatAndKeepsTheVolume) {
  const auto profile = depth_profile(block(0.0), ruler, volume_fraction);
  for (std::size_t k = 0; k < profile.x.size(); ++k) {
    EXPECT_DOUBLE_EQ(profile.x[k], (static_cast<double>(k) + 0.5) * bin);
    if (profile.x[k] < length - bin) {
      EXPECT_NEAR(profile.depth[k], height, 1e-3 * height) << k;
    } else if (profile.x[k] > length + bin) {
      EXPECT_EQ(profile.depth[k], 0.0) << k;
    }
  }
  const double area = bin * std::accumulate(profile.depth.begin(), profile.depth.end(), 0.0);
  EXPECT_NEAR(area, length * height, 1e-12);
}

TEST(ColumnCollapse, Wedge) {
  const auto measured = measure_column_collapse({block(0.0), wedge(1.0)}, ruler);
  const auto& observables = measured.observables;
  const double reach = wedge_reach / length;
  EXPECT_NEAR(observables.x90, reach * (1.0 - std::sqrt(0.10)), 1e-4);
  EXPECT_NEAR(observables.x95, reach * (1.0 - std::sqrt(0.05)), 1e-4);
  EXPECT_NEAR(observables.centre_of_mass, reach / 3.0, 1e-6);
  EXPECT_NEAR(observables.runout, reach * (1.0 - ruler.front_depth / height) - 1.0, 1e-4);
  // The highest bin is the first: the wall half of it lies level, so it reads the depth a third of a bin
  // farther out.
  EXPECT_NEAR(observables.final_height, height / length, bin / wedge_reach);
  const auto& profile = measured.final_profile;
  for (std::size_t k = 1; profile.x[k] < wedge_reach - bin; ++k) {
    EXPECT_NEAR(profile.depth[k], height * (1.0 - profile.x[k] / wedge_reach), 1e-6) << k;
  }
}

TEST(ColumnCollapse, ALoneEjectedItemDoesNotMoveTheFront) {
  Snapshot end = wedge(1.0);
  const double before = measure_column_collapse({block(0.0), end}, ruler).observables.runout;
  const double deep_enough = 2.0 * ruler.front_depth * bin * thickness * volume_fraction;
  add_item(end, 4.0 * length, deep_enough);
  const auto after = measure_column_collapse({block(0.0), end}, ruler);
  EXPECT_DOUBLE_EQ(after.observables.runout, before);
  // It is in the profile all the same, deeper than front_depth in its own place.
  EXPECT_GT(after.final_profile.x.back(), 4.0 * length);
  double beyond = 0.0;
  for (std::size_t k = 0; k < after.final_profile.x.size(); ++k) {
    if (after.final_profile.x[k] > 3.0 * length) beyond = std::max(beyond, after.final_profile.depth[k]);
  }
  EXPECT_GE(beyond, 0.99 * ruler.front_depth);
}

TEST(ColumnCollapse, NothingAtTheBackWallIsNoHeap) {
  const auto curves = measure_column_collapse({block(0.0), shifted(block(0.0), 1.0, length)}, ruler).curves;
  EXPECT_DOUBLE_EQ(curves.front.back(), 0.0);
}

TEST(ColumnCollapse, LostItemsAreCounted) {
  Snapshot end = deposit(1.0, length, [](double) { return 0.9 * height; });
  EXPECT_NEAR(measure_column_collapse({block(0.0), end}, ruler).observables.lost_volume, 0.1, 1e-9);
}

/// The block slides as 1 - exp(-t / tau): its centre is within 1 % of the end at a time known beforehand.
SnapshotSeries decaying_motion(double end_time, double tau, double distance) {
  SnapshotSeries series;
  constexpr int frames = 200;
  for (int k = 0; k <= frames; ++k) {
    const double time = end_time * k / frames;
    Snapshot coarse = deposit(0.0, length, [](double) { return height; });
    series.push_back(shifted(std::move(coarse), time, distance * (1.0 - std::exp(-time / tau))));
  }
  return series;
}

TEST(ColumnCollapse, StopTimeOfADecayingMotion) {
  constexpr double end_time = 1.0;
  constexpr double tau = 0.1;
  const auto measured = measure_column_collapse(decaying_motion(end_time, tau, 0.01), ruler).observables;
  // exp(-t/tau) - exp(-T/tau) = 0.01 (1 - exp(-T/tau))
  const double end = std::exp(-end_time / tau);
  const double expected = -tau * std::log(end + 0.01 * (1.0 - end));
  EXPECT_NEAR(measured.stop_time, expected, 0.001);  // a fifth of the snapshot interval
  EXPECT_TRUE(measured.at_rest);
}

TEST(ColumnCollapse, SteadyMotionIsNotAtRest) {
  SnapshotSeries series;
  for (int k = 0; k <= 20; ++k) {  // a wedge that grows by two bins in each snapshot
    const double reach = wedge_reach + 2.0 * bin * k;
    series.push_back(k == 0 ? block(0.0) : deposit(0.1 * k, reach, [=](double x) {
      return 2.0 * height * length / reach * (1.0 - x / reach);
    }));
  }
  const auto measured = measure_column_collapse(series, ruler).observables;
  EXPECT_FALSE(measured.at_rest);
  EXPECT_GT(measured.stop_time, 1.9);
}

/// A wedge of the block's volume whose front, after the release, is moved by `bins` at the given share of the
/// time.
bool rests_after_moving(double bins, double share) {
  SnapshotSeries series{block(0.0)};
  for (int k = 1; k <= 100; ++k) {
    const double reach = wedge_reach + (k > 100 * share ? bins * bin : 0.0);
    series.push_back(deposit(0.01 * k, reach,
                             [=](double x) { return 2.0 * height * length / reach * (1.0 - x / reach); }));
  }
  return measure_column_collapse(series, ruler).observables.at_rest;
}

TEST(ColumnCollapse, RestIsThatNeitherFrontNorBulkMovesOverTheLastTenthOfTheTime) {
  EXPECT_TRUE(rests_after_moving(0.01, 0.95));
  EXPECT_FALSE(rests_after_moving(0.9, 0.95));  // less than a bin, but the whole wedge with it
  EXPECT_FALSE(rests_after_moving(1.3, 0.95));
  EXPECT_FALSE(rests_after_moving(1.3, 0.91));
  EXPECT_TRUE(rests_after_moving(1.3, 0.89));
}

TEST(ColumnCollapse, OneSnapshotShowsNoRest) {
  EXPECT_FALSE(measure_column_collapse({block(0.0)}, ruler).observables.at_rest);
}

void expect_same(const CollapseObservables& a, const CollapseObservables& b) {
  constexpr double rounding = 1e-9;
  EXPECT_NEAR(a.runout, b.runout, rounding);
  EXPECT_NEAR(a.x90, b.x90, rounding);
  EXPECT_NEAR(a.x95, b.x95, rounding);
  EXPECT_NEAR(a.centre_of_mass, b.centre_of_mass, rounding);
  EXPECT_NEAR(a.final_height, b.final_height, rounding);
  EXPECT_NEAR(a.settled_height, b.settled_height, rounding);
  EXPECT_NEAR(a.stop_time, b.stop_time, rounding);
  EXPECT_EQ(a.at_rest, b.at_rest);
}

TEST(ColumnCollapse, TheOrderOfItemsDoesNotMatter) {
  const Snapshot end = wedge(1.0);
  std::vector<Eigen::Index> order(static_cast<std::size_t>(end.volumes.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(12345));
  const Snapshot shuffled{end.time, end.positions(Eigen::all, order), end.velocities(Eigen::all, order),
                          end.volumes(order)};
  expect_same(measure_column_collapse({block(0.0), end}, ruler).observables,
              measure_column_collapse({block(0.0), shuffled}, ruler).observables);
}

TEST(ColumnCollapse, ScalingAllVolumesOnlyScalesTheVolumeFraction) {
  SnapshotSeries series{block(0.0), wedge(1.0)};
  const auto before = measure_column_collapse(series, ruler).observables;
  for (Snapshot& snapshot : series) snapshot.volumes *= 1.0 / 3.0;
  const auto after = measure_column_collapse(series, ruler).observables;
  expect_same(before, after);
  EXPECT_NEAR(after.settled_volume_fraction, before.settled_volume_fraction / 3.0, 1e-9);
}

TEST(ColumnCollapse, SplittingItemsInPlaceChangesNothing) {
  const Snapshot end = wedge(1.0);
  Snapshot split{end.time, Vectors(3, 2 * end.volumes.size()), Vectors(3, 2 * end.volumes.size()),
                 Eigen::VectorXd(2 * end.volumes.size())};
  split.positions << end.positions, end.positions;
  split.velocities << end.velocities, end.velocities;
  split.volumes << 0.25 * end.volumes, 0.75 * end.volumes;
  expect_same(measure_column_collapse({block(0.0), end}, ruler).observables,
              measure_column_collapse({block(0.0), split}, ruler).observables);
}

TEST(VolumeQuantile, LiesBetweenItems) {
  Snapshot two{0.0, Vectors::Zero(3, 2), Vectors::Zero(3, 2), Eigen::Vector2d(1.0, 3.0)};
  two.positions(0, 0) = 1.0;
  two.positions(0, 1) = 2.0;
  // The halves of the items lie behind 1.0 (0.5 of 4) and 2.0 (2.5 of 4).
  EXPECT_DOUBLE_EQ(volume_quantile(two, 0.5 / 4.0), 1.0);
  EXPECT_DOUBLE_EQ(volume_quantile(two, 1.5 / 4.0), 1.5);
  EXPECT_DOUBLE_EQ(volume_quantile(two, 0.01), 1.0);
  EXPECT_DOUBLE_EQ(volume_quantile(two, 0.99), 2.0);
  EXPECT_THROW(volume_quantile(two, 0.0), std::invalid_argument);
  EXPECT_THROW(volume_quantile(two, 1.0), std::invalid_argument);
}

TEST(ColumnCollapse, SeriesThatCannotBeMeasured) {
  EXPECT_THROW(measure_column_collapse({}, ruler), SnapshotError);
  EXPECT_THROW(measure_column_collapse({block(0.5), block(1.0)}, ruler), SnapshotError);
  const Snapshot nothing{1.0, Vectors(3, 0), Vectors(3, 0), Eigen::VectorXd(0)};
  EXPECT_THROW(measure_column_collapse({block(0.0), nothing}, ruler), SnapshotError);
  EXPECT_THROW(measure_column_collapse({block(0.0), shifted(block(0.0), 1.0, -length)}, ruler),
               SnapshotError);
  Snapshot escaped = wedge(1.0);
  add_item(escaped, 1e9, 1e-9);
  EXPECT_THROW(measure_column_collapse({block(0.0), escaped}, ruler), SnapshotError);
  CollapseRuler broken = ruler;
  broken.bin_width = 0.0;
  EXPECT_THROW(measure_column_collapse({block(0.0)}, broken), std::invalid_argument);
}

}  // namespace
}  // namespace talus::analysis
