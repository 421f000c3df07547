#include "analysis/observables/solid_volume.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace talus::analysis {
namespace {

constexpr double release_tolerance = 1e-6;  // s; the first snapshot is the release itself

std::vector<Eigen::Index> ascending(const Eigen::VectorXd& values) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::sort(order.begin(), order.end(),
            [&](Eigen::Index a, Eigen::Index b) { return values[a] < values[b]; });
  return order;
}

}  // namespace

double total_volume(const Snapshot& snapshot) { return snapshot.volumes.sum(); }

void require_volume(const Snapshot& snapshot) {
  if (total_volume(snapshot) > 0.0) return;
  throw SnapshotError(fmt::format("the snapshot at t = {} s holds no volume", snapshot.time));
}

void require_release(const SnapshotSeries& series) {
  if (series.empty()) throw SnapshotError("no snapshots to measure");
  if (std::abs(series.front().time) > release_tolerance) {
    throw SnapshotError(
        fmt::format("the series starts at t = {} s, not at the release", series.front().time));
  }
  require_volume(series.front());
}

double volume_mean(const Eigen::VectorXd& values, const Eigen::VectorXd& volumes) {
  return values.dot(volumes) / volumes.sum();
}

double volume_quantile(const Eigen::VectorXd& values, const Eigen::VectorXd& volumes, double q) {
  if (!(q > 0.0 && q < 1.0)) throw std::invalid_argument(fmt::format("quantile {} is not in (0, 1)", q));
  const auto order = ascending(values);
  const double wanted = q * volumes.sum();
  double passed = 0.0;         // volume of all items behind this value
  double behind_before = 0.0;  // volume behind the value before, with half of what is there
  double value_before = values[order.front()];
  for (std::size_t first = 0, next = 0; first < order.size(); first = next) {
    // Items at the same value count as one, so that splitting an item changes nothing.
    const double value = values[order[first]];
    double volume = 0.0;
    for (; next < order.size() && values[order[next]] == value; ++next) volume += volumes[order[next]];
    const double behind = passed + 0.5 * volume;
    if (behind >= wanted) {
      if (first == 0) return value;
      return value_before + (value - value_before) * (wanted - behind_before) / (behind - behind_before);
    }
    passed += volume;
    behind_before = behind;
    value_before = value;
  }
  return values[order.back()];
}

}  // namespace talus::analysis
