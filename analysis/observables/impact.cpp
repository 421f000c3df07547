#include "analysis/observables/impact.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/observables/settling.h"

namespace talus::analysis {
namespace {

constexpr double stopped_share = 0.05;  // of the speed at contact
constexpr double rest_share = 0.01;     // of the diameter
constexpr double latest_contact = 0.1;  // of the record

/// Depth below the surface and downward speed at the rows.
struct Fall {
  std::vector<double> time, depth, speed;
};

Fall fall_of(const BodyTrack& track, double surface, double radius) {
  Fall fall;
  for (const BodyMoment& moment : track) {
    fall.time.push_back(moment.time);
    fall.depth.push_back(surface - (moment.position.z() - radius));
    fall.speed.push_back(-moment.velocity.z());
  }
  return fall;
}

/// Linear between rows; `time` lies within them.
double value_at(const Fall& fall, const std::vector<double>& values, double time) {
  const auto after = std::upper_bound(fall.time.begin() + 1, fall.time.end() - 1, time);
  const auto k = static_cast<std::size_t>(after - fall.time.begin());
  const double share = (time - fall.time[k - 1]) / (fall.time[k] - fall.time[k - 1]);
  return (1.0 - share) * values[k - 1] + share * values[k];
}

double contact_time(const Fall& fall) {
  if (fall.depth.front() > 0.0) {
    throw SnapshotError(
        fmt::format("the sphere starts {:.3g} m below the surface of the bed", fall.depth.front()));
  }
  const auto below = std::find_if(fall.depth.begin(), fall.depth.end(), [](double d) { return d > 0.0; });
  const auto k = static_cast<std::size_t>(below - fall.depth.begin());
  const double length = fall.time.back() - fall.time.front();
  if (below == fall.depth.end() || fall.time[k] > fall.time.front() + latest_contact * length)
    throw SnapshotError("the sphere does not reach the bed within a tenth of the time");
  const double step = fall.time[k] - fall.time[k - 1];
  return fall.time[k - 1] - step * fall.depth[k - 1] / (fall.depth[k] - fall.depth[k - 1]);
}

/// The first moment after contact at which the speed falls below `slow`.
double slow_time(const Fall& fall, double contact, double slow) {
  for (std::size_t k = 1; k < fall.time.size(); ++k) {
    if (fall.time[k] <= contact || fall.speed[k] >= slow) continue;
    const double before = fall.speed[k - 1];
    return fall.time[k - 1] + (fall.time[k] - fall.time[k - 1]) * (before - slow) / (before - fall.speed[k]);
  }
  throw SnapshotError("the sphere does not stop before the end");
}

ImpactCurves curves_of(const Fall& fall, double contact) {
  const auto rows = fall.time.size() - 1;
  const double interval = (fall.time.back() - fall.time.front()) / static_cast<double>(rows);
  const auto count = static_cast<std::size_t>((1.0 - latest_contact) * static_cast<double>(rows));
  ImpactCurves curves;
  for (std::size_t k = 0; k <= count; ++k) {
    const double time = static_cast<double>(k) * interval;
    curves.time.push_back(time);
    curves.depth.push_back(value_at(fall, fall.depth, contact + time));
    curves.speed.push_back(value_at(fall, fall.speed, contact + time));
  }
  return curves;
}

/// The hat of the last ring ends at the sides.
DepthProfile crater(const Snapshot& snapshot, double volume_fraction, const ImpactRuler& ruler) {
  const auto bins = static_cast<std::size_t>(std::max(1.0, 0.5 * ruler.side / ruler.bin_width - 0.5));
  const Eigen::VectorXd radii = snapshot.positions.topRows<2>().colwise().norm();
  const auto volumes = share_by_bins(radii, snapshot.volumes, ruler.bin_width, bins);
  Rings ring = rings(ruler.bin_width, bins);
  DepthProfile profile{std::move(ring.radius), {}};
  for (std::size_t bin = 0; bin < bins; ++bin)
    profile.depth.push_back(volumes[bin] / (ring.area[bin] * volume_fraction));
  return profile;
}

}  // namespace

Impact measure_impact(const SnapshotSeries& series, const BodyTrack& track, const ImpactRuler& ruler) {
  if (series.empty() || series.front().volumes.size() == 0) throw SnapshotError("there is no bed");
  if (track.size() < 2) throw SnapshotError("the sphere's track has fewer than two rows");
  const Snapshot& release = series.front();
  const double volume = release.volumes.sum();
  const double surface = 2.0 * release.positions.row(2).dot(release.volumes) / volume;
  const double volume_fraction = volume / (ruler.side * ruler.side * surface);
  const Fall fall = fall_of(track, surface, ruler.sphere_radius);
  const double contact = contact_time(fall), speed = value_at(fall, fall.speed, contact);
  return {.observables = {.penetration_depth = fall.depth.back(),
                          .stop_time = slow_time(fall, contact, stopped_share * speed) - contact,
                          .contact_speed = speed,
                          .settled_height = surface,
                          .settled_volume_fraction = volume_fraction,
                          .lost_volume = 1.0 - series.back().volumes.sum() / volume,
                          .at_rest =
                              range_at_end(fall.time, fall.depth) <= rest_share * 2.0 * ruler.sphere_radius},
          .curves = curves_of(fall, contact),
          .final_profile = crater(series.back(), volume_fraction, ruler)};
}

}  // namespace talus::analysis
