// The discharge ruler on reservoirs that empty at a known rate.
#include "analysis/observables/discharge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>

namespace talus::analysis {
namespace {

constexpr double grain_density = 2500.0;  // kg/m^3
constexpr double grain_volume = 1e-8;     // m^3
constexpr int grains = 10000;
const DischargeRuler ruler{.opening = Eigen::Vector3d(0.0, 0.0, 0.1), .grain_density = grain_density};

/// Of all grains, `above` stand above the opening and the rest below it. Those that stand together count as one item.
Snapshot reservoir(double time, int above) {
  Snapshot snapshot{time, Vectors::Zero(3, 2), Vectors::Zero(3, 2),
                    Eigen::Vector2d(above * grain_volume, (grains - above) * grain_volume)};
  snapshot.positions.row(2) << 0.2, 0.05;
  return snapshot;
}

/// `frames` intervals over `end` seconds; fill(t) is the share above the opening.
SnapshotSeries draining(int frames, double end, const std::function<double(double)>& fill) {
  SnapshotSeries series;
  for (int k = 0; k <= frames; ++k) {
    const double time = end * k / frames;
    series.push_back(reservoir(time, static_cast<int>(std::lround(grains * fill(time)))));
  }
  return series;
}

double steady(double time) { return std::max(0.05, 1.0 - 0.5 * time); }  // a twentieth stays for ever

TEST(Discharge, SteadyRate) {
  const auto measured = measure_discharge(draining(300, 3.0, steady), ruler);
  const auto& observables = measured.observables;
  const double rate = 0.5 * grains * grain_volume * grain_density;
  EXPECT_NEAR(observables.rate, rate, 1e-4 * rate);
  EXPECT_LT(observables.rate_standard_error, 1e-4 * rate);
  EXPECT_NEAR(observables.flatness, 1.0, 1e-4);
  EXPECT_NEAR(observables.window_start, 0.2, 0.011);  // one snapshot interval
  EXPECT_NEAR(observables.window_end, 1.4, 0.011);
  EXPECT_NEAR(observables.residual, 0.05, 1e-12);
  // 0.95 of the grains leave within 1.9 s; 1 % of them are still there at 0.019 s before.
  ASSERT_TRUE(observables.emptied_time.has_value());
  EXPECT_NEAR(*observables.emptied_time, 1.9 - 0.019, 1e-3);
  EXPECT_EQ(measured.curve.time.size(), 301u);
  EXPECT_NEAR(measured.curve.mass.front(), grains * grain_volume * grain_density, 1e-12);
}

TEST(Discharge, StartAndEndOutsideTheWindowDoNotCount) {
  // Three times as fast above 0.92 and a third as fast below 0.28 of the fill.
  const auto fill = [](double time) {
    const double fast_end = 0.08 / 1.5;
    const double middle_end = fast_end + 0.64 / 0.5;
    if (time < fast_end) return 1.0 - 1.5 * time;
    if (time < middle_end) return 0.92 - 0.5 * (time - fast_end);
    return std::max(0.0, 0.28 - 0.17 * (time - middle_end));
  };
  const auto measured = measure_discharge(draining(600, 6.0, fill), ruler).observables;
  const double rate = 0.5 * grains * grain_volume * grain_density;
  EXPECT_NEAR(measured.rate, rate, 1e-3 * rate);
  EXPECT_NEAR(measured.flatness, 1.0, 2e-3);
}

TEST(Discharge, FallingRateIsNotFlat) {
  // fill = (1 - t/2)^2: the rate falls linearly with time, so between t0 and t1 its halves have the ratio of the rates at
  // the two quarter points.
  const auto fill = [](double time) { return time < 2.0 ? std::pow(1.0 - 0.5 * time, 2) : 0.0; };
  const auto measured = measure_discharge(draining(2000, 2.5, fill), ruler).observables;
  const double start = 2.0 * (1.0 - std::sqrt(0.9)), end = 2.0 * (1.0 - std::sqrt(0.3));
  const auto rate = [](double time) { return 1.0 - 0.5 * time; };
  const double early = rate(0.75 * start + 0.25 * end), late = rate(0.25 * start + 0.75 * end);
  EXPECT_NEAR(measured.flatness, early / late, 5e-3);
  EXPECT_GT(measured.rate_standard_error, 0.02 * measured.rate);
}

/// Grains that leave at random times (a Poisson stream): the number out in a time has the variance of its mean.
TEST(Discharge, StandardErrorIsThatOfARandomStream) {
  constexpr int trials = 300;
  const double rate = 0.5 * grains * grain_volume * grain_density;
  double squared_deviation = 0.0, squared_error = 0.0;
  std::mt19937 generator(20240607);
  for (int trial = 0; trial < trials; ++trial) {
    const double interval = 0.01;
    std::poisson_distribution<int> leaving(0.5 * grains * interval);
    SnapshotSeries series;
    int above = grains;
    for (int k = 0; above > 0; ++k, above -= leaving(generator))
      series.push_back(reservoir(k * interval, above));
    const auto measured = measure_discharge(series, ruler).observables;
    squared_deviation += std::pow(measured.rate - rate, 2) / trials;
    squared_error += std::pow(measured.rate_standard_error, 2) / trials;
  }
  // Mean squares of 300 trials: known within sqrt(2/300) = 8 % and, with 4 degrees of freedom each, 4 %.
  EXPECT_NEAR(std::sqrt(squared_error / squared_deviation), 1.0, 0.15);
  EXPECT_NEAR(std::sqrt(squared_deviation), std::sqrt(1.2 * 6000) / 6000 * rate,
              0.1 * std::sqrt(1.2 / 6000) * rate);
}

TEST(Discharge, AnyPlane) {
  SnapshotSeries series = draining(300, 3.0, steady);
  const double rate = measure_discharge(series, ruler).observables.rate;
  for (Snapshot& snapshot : series) snapshot.positions.row(0).swap(snapshot.positions.row(2));
  DischargeRuler sideways = ruler;
  sideways.opening = Eigen::Vector3d(0.1, 3.0, -7.0);
  sideways.upward = Eigen::Vector3d(2.0, 0.0, 0.0);
  EXPECT_DOUBLE_EQ(measure_discharge(series, sideways).observables.rate, rate);
}

TEST(Discharge, StillFlowingHasNoEmptiedTime) {
  const auto measured =
      measure_discharge(draining(300, 1.8, steady), ruler).observables;  // ends at a tenth of the fill
  EXPECT_FALSE(measured.emptied_time.has_value());
  EXPECT_NEAR(measured.residual, 0.1, 1e-3);
}

TEST(Discharge, SeriesThatCannotBeMeasured) {
  EXPECT_THROW(measure_discharge({}, ruler), SnapshotError);
  const auto still = [](double) { return 1.0; };
  EXPECT_THROW(measure_discharge(draining(100, 1.0, still), ruler), SnapshotError);
  const auto clogged = [](double time) { return std::max(0.6, 1.0 - time); };
  EXPECT_THROW(measure_discharge(draining(100, 1.0, clogged), ruler), SnapshotError);
  EXPECT_THROW(measure_discharge(draining(30, 3.0, steady), ruler),
               SnapshotError);  // 13 snapshots in the window
  EXPECT_NO_THROW(measure_discharge(draining(40, 3.0, steady), ruler));
  const auto below = [](double) { return 0.0; };
  EXPECT_THROW(measure_discharge(draining(100, 1.0, below), ruler), SnapshotError);
  SnapshotSeries late = draining(300, 3.0, steady);
  late.erase(late.begin());
  EXPECT_THROW(measure_discharge(late, ruler), SnapshotError);
}

TEST(Discharge, BrokenRulers) {
  const auto series = draining(300, 3.0, steady);
  const auto expect_refused = [&](auto&& spoil) {
    DischargeRuler broken = ruler;
    spoil(broken);
    EXPECT_THROW(measure_discharge(series, broken), std::invalid_argument);
  };
  expect_refused([](DischargeRuler& broken) { broken.grain_density = 0.0; });
  expect_refused([](DischargeRuler& broken) { broken.least_fill = 0.9; });
  expect_refused([](DischargeRuler& broken) { broken.most_fill = 1.1; });
  expect_refused([](DischargeRuler& broken) { broken.upward.setZero(); });
  expect_refused([](DischargeRuler& broken) { broken.blocks = 2; });
}

}  // namespace
}  // namespace talus::analysis
