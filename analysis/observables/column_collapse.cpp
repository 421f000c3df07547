#include "analysis/observables/column_collapse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "analysis/observables/binned_depth.h"
#include "analysis/observables/settling.h"
#include "analysis/observables/solid_volume.h"

namespace talus::analysis {
namespace {

constexpr double rest_motion = 2e-3;    // of L0, within the last tenth of the time
constexpr double stop_fraction = 0.01;  // of the total displacement of the centre of mass

/// Volume-weighted mean of one coordinate (0: x, 2: z).
double mean_coordinate(const Snapshot& snapshot, int axis) {
  return volume_mean(snapshot.positions.row(axis), snapshot.volumes);
}

CollapseCurves curves_of(const SnapshotSeries& series, const CollapseRuler& ruler, double volume_fraction) {
  CollapseCurves curves;
  for (const Snapshot& snapshot : series) {
    require_volume(snapshot);
    const DepthProfile profile = depth_profile(snapshot, ruler, volume_fraction);
    curves.time.push_back(snapshot.time);
    curves.front.push_back(front_of(profile, ruler.front_depth));
    curves.x95.push_back(volume_quantile(snapshot, 0.95));
    curves.centre_of_mass.push_back(mean_coordinate(snapshot, 0));
    curves.height.push_back(*std::max_element(profile.depth.begin(), profile.depth.end()));
  }
  return curves;
}

bool is_at_rest(const CollapseCurves& curves, const CollapseRuler& ruler) {
  // The front is read to within a bin; what flows unseen behind it moves the centre of mass and x95.
  const double least_motion = rest_motion * ruler.column_length;
  return range_at_end(curves.time, curves.front) < ruler.bin_width &&
         range_at_end(curves.time, curves.centre_of_mass) < least_motion &&
         range_at_end(curves.time, curves.x95) < least_motion;
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
  require_release(series);
  const Snapshot& release = series.front();
  const Snapshot& end = series.back();
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
      .stop_time = settling_time(measurement.curves.time, measurement.curves.centre_of_mass, stop_fraction),
      .settled_height = settled_height / length,
      .settled_volume_fraction = volume_fraction,
      .lost_volume = 1.0 - total_volume(end) / total_volume(release),
      .at_rest = is_at_rest(measurement.curves, ruler),
  };
  return measurement;
}

DepthProfile depth_profile(const Snapshot& snapshot, const CollapseRuler& ruler, double volume_fraction) {
  const double width = ruler.bin_width;
  const Eigen::VectorXd x = snapshot.positions.row(0);
  if (x.size() > 0 && x.minCoeff() < -width) {
    throw SnapshotError(fmt::format("at t = {} s an item is at x = {} m: it has passed through the back wall",
                                    snapshot.time, x.minCoeff()));
  }
  const std::size_t bins = bins_to_hold(x, width, snapshot.time);
  const double depth_of_volume = 1.0 / (width * ruler.thickness * volume_fraction);
  DepthProfile profile{std::vector<double>(bins),
                       share_by_bins(x, depth_of_volume * snapshot.volumes, width, bins)};
  for (std::size_t bin = 0; bin < bins; ++bin) profile.x[bin] = (static_cast<double>(bin) + 0.5) * width;
  return profile;
}

double volume_quantile(const Snapshot& snapshot, double q) {
  require_volume(snapshot);
  return volume_quantile(snapshot.positions.row(0), snapshot.volumes, q);
}

}  // namespace talus::analysis
