#include "analysis/observables/discharge.h"

#include <fmt/format.h>
#include <gsl/gsl_fit.h>

#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>

#include "analysis/observables/settling.h"
#include "analysis/observables/solid_volume.h"
#include "analysis/statistics/ensemble.h"

namespace talus::analysis {
namespace {

constexpr std::size_t block_snapshots = 3;  // a line through two leaves nothing to average
constexpr double emptied_share = 0.01;      // of the discharged volume
constexpr double rest_share = 2e-3;         // of the released volume, over the last tenth of the time

/// Part of the curve, from `first` on.
struct Window {
  std::size_t first, count;
};

void check_ruler(const DischargeRuler& ruler) {
  if (!ruler.opening.allFinite() || !ruler.upward.allFinite() || ruler.upward.isZero()) {
    throw std::invalid_argument("DischargeRuler: opening and upward must be finite, and upward not zero");
  }
  if (!(ruler.grain_density > 0.0) || !std::isfinite(ruler.grain_density)) {
    throw std::invalid_argument(
        fmt::format("DischargeRuler: grain_density is {}, but must be positive", ruler.grain_density));
  }
  if (!(0.0 < ruler.least_fill && ruler.least_fill < ruler.most_fill && ruler.most_fill <= 1.0)) {
    throw std::invalid_argument(
        fmt::format("DischargeRuler: 0 < least_fill < most_fill <= 1 is broken by {} and {}",
                    ruler.least_fill, ruler.most_fill));
  }
  if (ruler.blocks < 3) {
    throw std::invalid_argument(
        fmt::format("DischargeRuler: blocks is {}, but must be at least 3", ruler.blocks));
  }
}

double volume_above(const Snapshot& snapshot, const DischargeRuler& ruler) {
  const auto height = ruler.upward.transpose() * (snapshot.positions.colwise() - ruler.opening);
  return (height.array() > 0.0).select(snapshot.volumes.transpose().array(), 0.0).sum();
}

Window window_of(const DischargeCurve& curve, const DischargeRuler& ruler) {
  const auto& volume = curve.volume;
  std::size_t first = 0;
  while (first < volume.size() && volume[first] > ruler.most_fill * volume.front()) ++first;
  if (first == volume.size()) {
    throw SnapshotError(
        fmt::format("the reservoir does not drain: at the end, t = {} s, {:.3g} of it is above the opening",
                    curve.time.back(), volume.back() / volume.front()));
  }
  std::size_t end = first;
  while (end < volume.size() && volume[end] >= ruler.least_fill * volume.front()) ++end;
  if (end == volume.size()) {
    throw SnapshotError(fmt::format(
        "the reservoir drains to {:.3g} of its fill only, not to {}: it clogged or was stopped too soon",
        volume.back() / volume.front(), ruler.least_fill));
  }
  const Window window{first, end - first};
  const std::size_t needed = block_snapshots * static_cast<std::size_t>(ruler.blocks);
  if (window.count < needed) {
    throw SnapshotError(fmt::format(
        "{} snapshots while the fill is between {} and {}, but {} are needed: write them more often",
        window.count, ruler.most_fill, ruler.least_fill, needed));
  }
  return window;
}

/// Mass that leaves per time, by least squares.
double rate_of(const DischargeCurve& curve, Window window) {
  double intercept, slope, variance0, covariance, variance1, squares;
  gsl_fit_linear(curve.time.data() + window.first, 1, curve.mass.data() + window.first, 1, window.count,
                 &intercept, &slope, &variance0, &covariance, &variance1, &squares);
  return -slope;
}

/// Standard error of the mean of the block rates; what does not divide into blocks is left out at the end.
double block_error(const DischargeCurve& curve, Window window, std::size_t blocks) {
  const std::size_t count = window.count / blocks;
  std::vector<double> rates;
  for (std::size_t block = 0; block < blocks; ++block) {
    rates.push_back(rate_of(curve, {window.first + block * count, count}));
  }
  return ensemble_statistics(rates).standard_deviation / std::sqrt(static_cast<double>(blocks));
}

std::optional<double> emptied_time(const DischargeCurve& curve) {
  if (range_at_end(curve.time, curve.volume) > rest_share * curve.volume.front()) return std::nullopt;
  return settling_time(curve.time, curve.volume, emptied_share);
}

}  // namespace

DischargeCurve discharge_curve(const SnapshotSeries& series, const DischargeRuler& ruler) {
  check_ruler(ruler);
  require_release(series);
  DischargeCurve curve;
  for (const Snapshot& snapshot : series) {
    const double volume = volume_above(snapshot, ruler);
    curve.time.push_back(snapshot.time);
    curve.volume.push_back(volume);
    curve.mass.push_back(ruler.grain_density * volume);
  }
  if (!(curve.volume.front() > 0.0)) throw SnapshotError("nothing is above the opening at release");
  return curve;
}

DischargeMeasurement measure_discharge(const SnapshotSeries& series, const DischargeRuler& ruler) {
  DischargeMeasurement measurement{{}, discharge_curve(series, ruler)};
  const DischargeCurve& curve = measurement.curve;
  const Window window = window_of(curve, ruler);
  const std::size_t half = window.count / 2;
  const double late_rate = rate_of(curve, {window.first + half, window.count - half});
  measurement.observables = {
      .rate = rate_of(curve, window),
      .rate_standard_error = block_error(curve, window, static_cast<std::size_t>(ruler.blocks)),
      .flatness = rate_of(curve, {window.first, half}) / late_rate,
      .window_start = curve.time[window.first],
      .window_end = curve.time[window.first + window.count - 1],
      .residual = curve.volume.back() / curve.volume.front(),
      .emptied_time = emptied_time(curve),
  };
  return measurement;
}

}  // namespace talus::analysis
