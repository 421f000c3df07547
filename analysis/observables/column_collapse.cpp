#include "analysis/observables/column_collapse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <stdexcept>

namespace talus::analysis {
namespace {

constexpr double release_tolerance = 1e-6;  // s; the first snapshot is the release itself
constexpr double rest_window = 0.1;         // of the whole time, at its end
constexpr double rest_motion = 2e-3;        // of L0, within that window
constexpr double stop_fraction = 0.01;      // of the total displacement of the centre of mass
constexpr double most_bins = 1e6;           // an item farther away than this has escaped

double total_volume(const Snapshot& snapshot) { return snapshot.volumes.sum(); }

/// Volume-weighted mean of one coordinate (0: x, 2: z).
double mean_coordinate(const Snapshot& snapshot, int axis) {
  return snapshot.positions.row(axis).dot(snapshot.volumes) / total_volume(snapshot);
}

void require_volume(const Snapshot& snapshot) {
  if (total_volume(snapshot) > 0.0) return;
  throw SnapshotError(fmt::format("the snapshot at t = {} s holds no volume", snapshot.time));
}

/// Front of the heap: the first crossing of front_depth, seen from the back wall.
double front_of(const DepthProfile& profile, const CollapseRuler& ruler) {
  const auto edge = std::find_if(profile.depth.begin(), profile.depth.end(),
                                 [&](double depth) { return depth < ruler.front_depth; });
  const auto first_low = static_cast<std::size_t>(edge - profile.depth.begin());
  if (first_low == 0) return 0.0;  // nothing is joined to the back wall
  const double high = profile.depth[first_low - 1];
  const double low = profile.depth[first_low];
  return profile.x[first_low - 1] + ruler.bin_width * (high - ruler.front_depth) / (high - low);
}

CollapseCurves curves_of(const SnapshotSeries& series, const CollapseRuler& ruler, double volume_fraction) {
  CollapseCurves curves;
  for (const Snapshot& snapshot : series) {
    require_volume(snapshot);
    const DepthProfile profile = depth_profile(snapshot, ruler, volume_fraction);
    curves.time.push_back(snapshot.time);
    curves.front.push_back(front_of(profile, ruler));
    curves.x95.push_back(volume_quantile(snapshot, 0.95));
    curves.centre_of_mass.push_back(mean_coordinate(snapshot, 0));
    curves.height.push_back(*std::max_element(profile.depth.begin(), profile.depth.end()));
  }
  return curves;
}

/// When the centre of mass comes within the tolerance of its end for good.
double stop_time_of(const CollapseCurves& curves) {
  const auto& place = curves.centre_of_mass;
  const double tolerance = stop_fraction * std::abs(place.back() - place.front());
  const auto distance = [&](std::size_t k) { return std::abs(place[k] - place.back()); };
  std::size_t last_outside = place.size() - 1;
  while (last_outside > 0 && distance(last_outside) <= tolerance) --last_outside;
  if (distance(last_outside) <= tolerance) return curves.time.front();  // it never moved
  const double outside = distance(last_outside);
  const double inside = distance(last_outside + 1);
  const double step = curves.time[last_outside + 1] - curves.time[last_outside];
  return curves.time[last_outside] + step * (outside - tolerance) / (outside - inside);
}

/// One snapshot alone shows no rest.
bool is_at_rest(const CollapseCurves& curves, const CollapseRuler& ruler) {
  const auto& time = curves.time;
  const double window_start = time.back() - rest_window * (time.back() - time.front());
  std::size_t first = time.size() - 1;
  // The window is covered whole: from the last snapshot that is not after its start.
  while (first > 0 && time[first] > window_start) --first;
  if (first + 1 == time.size()) return false;
  const auto range = [&](const std::vector<double>& curve) {
    const auto [least, most] =
        std::minmax_element(curve.begin() + static_cast<std::ptrdiff_t>(first), curve.end());
    return *most - *least;
  };
  // The front is read to within a bin; what flows unseen behind it moves the centre of mass and x95.
  const double least_motion = rest_motion * ruler.column_length;
  return range(curves.front) < ruler.bin_width && range(curves.centre_of_mass) < least_motion &&
         range(curves.x95) < least_motion;
}

void check_ruler(const CollapseRuler& ruler) {
  for (const double length : {ruler.column_length, ruler.thickness, ruler.bin_width, ruler.front_depth}) {
    if (!(length > 0.0) || !std::isfinite(length)) {
      throw std::invalid_argument(fmt::format("CollapseRuler: a length is {}, but must be positive", length));
    }
  }
}

}  // namespace

CollapseMeasurement measure_column_collapse(const SnapshotSeries& series, const CollapseRuler& ruler) {
  check_ruler(ruler);
  if (series.empty()) throw SnapshotError("no snapshots to measure");
  if (std::abs(series.front().time) > release_tolerance) {
    throw SnapshotError(
        fmt::format("the series starts at t = {} s, not at the release", series.front().time));
  }
  const Snapshot& release = series.front();
  const Snapshot& end = series.back();
  require_volume(release);
  require_volume(end);

  const double length = ruler.column_length;
  const double settled_height = 2.0 * mean_coordinate(release, 2);
  if (!(settled_height > 0.0)) throw SnapshotError("at release the centre of mass is not above the floor");
  const double volume_fraction = total_volume(release) / (length * ruler.thickness * settled_height);

  CollapseMeasurement measurement;
  measurement.curves = curves_of(series, ruler, volume_fraction);
  measurement.final_profile = depth_profile(end, ruler, volume_fraction);
  measurement.observables = {
      .runout = (measurement.curves.front.back() - length) / length,
      .x90 = volume_quantile(end, 0.90) / length,
      .x95 = measurement.curves.x95.back() / length,
      .centre_of_mass = measurement.curves.centre_of_mass.back() / length,
      .final_height = measurement.curves.height.back() / length,
      .stop_time = stop_time_of(measurement.curves),
      .settled_height = settled_height / length,
      .settled_volume_fraction = volume_fraction,
      .lost_volume = 1.0 - total_volume(end) / total_volume(release),
      .at_rest = is_at_rest(measurement.curves, ruler),
  };
  return measurement;
}

DepthProfile depth_profile(const Snapshot& snapshot, const CollapseRuler& ruler, double volume_fraction) {
  const double width = ruler.bin_width;
  const auto x = snapshot.positions.row(0);
  if (snapshot.volumes.size() > 0) {
    if (x.minCoeff() < -width) {
      throw SnapshotError(
          fmt::format("at t = {} s an item is at x = {} m: it has passed through the back wall",
                      snapshot.time, x.minCoeff()));
    }
    if (x.maxCoeff() > most_bins * width) {
      throw SnapshotError(fmt::format("at t = {} s an item is at x = {} m: it has left the tank",
                                      snapshot.time, x.maxCoeff()));
    }
  }
  // Two bins beyond the last item: the last one is always empty, so every heap has an end.
  const double reach = snapshot.volumes.size() > 0 ? std::max(0.0, x.maxCoeff()) : 0.0;
  const auto bins = static_cast<std::size_t>(reach / width) + 3;
  DepthProfile profile{std::vector<double>(bins), std::vector<double>(bins, 0.0)};
  for (std::size_t bin = 0; bin < bins; ++bin) profile.x[bin] = (static_cast<double>(bin) + 0.5) * width;

  const double depth_of_volume = 1.0 / (width * ruler.thickness * volume_fraction);
  for (Eigen::Index item = 0; item < x.size(); ++item) {
    const double place = std::max(0.0, x[item] / width - 0.5);  // in bins, from the first bin's centre
    const auto bin = static_cast<std::size_t>(place);
    const double share = place - static_cast<double>(bin);
    const double depth = snapshot.volumes[item] * depth_of_volume;
    profile.depth[bin] += (1.0 - share) * depth;
    profile.depth[bin + 1] += share * depth;
  }
  return profile;
}

double volume_quantile(const Snapshot& snapshot, double q) {
  if (!(q > 0.0 && q < 1.0)) throw std::invalid_argument(fmt::format("quantile {} is not in (0, 1)", q));
  require_volume(snapshot);
  const auto x = snapshot.positions.row(0);
  std::vector<Eigen::Index> order(static_cast<std::size_t>(x.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return x[a] < x[b]; });

  const double wanted = q * total_volume(snapshot);
  double passed = 0.0;         // volume of all items behind this x
  double behind_before = 0.0;  // volume behind the x before, with half of what is there
  double x_before = x[order.front()];
  for (std::size_t first = 0, next = 0; first < order.size(); first = next) {
    // Items at the same x count as one, so that splitting an item changes nothing.
    const double x_here = x[order[first]];
    double volume = 0.0;
    for (; next < order.size() && x[order[next]] == x_here; ++next) volume += snapshot.volumes[order[next]];
    const double behind = passed + 0.5 * volume;
    if (behind >= wanted) {
      if (first == 0) return x_here;
      return x_before + (x_here - x_before) * (wanted - behind_before) / (behind - behind_before);
    }
    passed += volume;
    behind_before = behind;
    x_before = x_here;
  }
  return x[order.back()];
}

}  // namespace talus::analysis
