#include "analysis/observables/cylinder_collapse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>

#include "analysis/observables/settling.h"
#include "analysis/observables/solid_volume.h"
#include "analysis/statistics/ensemble.h"

namespace talus::analysis {
namespace {

constexpr double rest_motion = 2e-3;    // of R0, within the last tenth of the time
constexpr double stop_fraction = 0.01;  // of the total change of the mean radius
constexpr int sectors = 8;              // for the roundness

void check_ruler(const CylinderRuler& ruler) {
  for (const double length : {ruler.radius, ruler.bin_width, ruler.front_depth}) {
    if (!(length > 0.0) || !std::isfinite(length)) {
      throw std::invalid_argument(fmt::format("CylinderRuler: a length is {}, but must be positive", length));
    }
  }
  if (!ruler.axis.allFinite()) throw std::invalid_argument("CylinderRuler: the axis must be finite");
}

Eigen::Matrix2Xd arms(const Snapshot& snapshot, const CylinderRuler& ruler) {
  return snapshot.positions.topRows<2>().colwise() - ruler.axis;
}

DepthProfile depth_by_rings(const Eigen::VectorXd& radius, const Eigen::VectorXd& volume, double width,
                            double time) {
  const std::size_t bins = bins_to_hold(radius, width, time);
  Rings circle = rings(width, bins);
  DepthProfile profile{std::move(circle.radius), share_by_bins(radius, volume, width, bins)};
  for (std::size_t bin = 0; bin < bins; ++bin) profile.depth[bin] /= circle.area[bin];
  return profile;
}

CylinderCurves curves_of(const SnapshotSeries& series, const CylinderRuler& ruler, double volume_fraction) {
  CylinderCurves curves;
  for (const Snapshot& snapshot : series) {
    require_volume(snapshot);
    const DepthProfile profile = radial_depth_profile(snapshot, ruler, volume_fraction);
    const Eigen::VectorXd radius = arms(snapshot, ruler).colwise().norm();
    curves.time.push_back(snapshot.time);
    curves.front.push_back(front_of(profile, ruler.front_depth));
    curves.r95.push_back(volume_quantile(radius, snapshot.volumes, 0.95));
    curves.mean_radius.push_back(volume_mean(radius, snapshot.volumes));
    curves.height.push_back(*std::ranges::max_element(profile.depth));
  }
  return curves;
}

/// Front of one sector. Its inner rings hold few grains and may be empty by chance: looked at from half the way out on.
double sector_front(const Snapshot& snapshot, const CylinderRuler& ruler, double volume_fraction, int sector,
                    double front) {
  const Eigen::Matrix2Xd arm = arms(snapshot, ruler);
  Eigen::VectorXd volume = snapshot.volumes * (sectors / volume_fraction);
  for (Eigen::Index item = 0; item < volume.size(); ++item) {
    const double turn = std::atan2(arm(1, item), arm(0, item)) / (2.0 * std::numbers::pi) + 0.5;  // in [0, 1]
    if (std::min(static_cast<int>(turn * sectors), sectors - 1) != sector) volume[item] = 0.0;
  }
  const DepthProfile profile = depth_by_rings(arm.colwise().norm(), volume, ruler.bin_width, snapshot.time);
  return front_of(profile, ruler.front_depth, static_cast<std::size_t>(0.5 * front / ruler.bin_width));
}

double roundness_of(const Snapshot& snapshot, const CylinderRuler& ruler, double volume_fraction,
                    double front) {
  std::vector<double> fronts;
  for (int sector = 0; sector < sectors; ++sector) {
    fronts.push_back(sector_front(snapshot, ruler, volume_fraction, sector, front));
  }
  const EnsembleStatistics statistics = ensemble_statistics(fronts);
  return statistics.standard_deviation / statistics.mean;
}

double drift_of(const Snapshot& snapshot, const CylinderRuler& ruler) {
  const Eigen::Vector2d moment = arms(snapshot, ruler) * snapshot.volumes;
  return moment.norm() / total_volume(snapshot);
}

bool is_at_rest(const CylinderCurves& curves, const CylinderRuler& ruler) {
  const double least_motion = rest_motion * ruler.radius;
  return range_at_end(curves.time, curves.front) < ruler.bin_width &&
         range_at_end(curves.time, curves.mean_radius) < least_motion &&
         range_at_end(curves.time, curves.r95) < least_motion;
}

}  // namespace

DepthProfile radial_depth_profile(const Snapshot& snapshot, const CylinderRuler& ruler,
                                  double volume_fraction) {
  return depth_by_rings(arms(snapshot, ruler).colwise().norm(), snapshot.volumes / volume_fraction,
                        ruler.bin_width, snapshot.time);
}

CylinderMeasurement measure_cylinder_collapse(const SnapshotSeries& series, const CylinderRuler& ruler) {
  check_ruler(ruler);
  require_release(series);
  const Snapshot& release = series.front();
  const Snapshot& end = series.back();
  const double settled_height = 2.0 * volume_mean(release.positions.row(2), release.volumes);
  if (!(settled_height > 0.0)) throw SnapshotError("at release the centre of mass is not above the floor");
  const double base = std::numbers::pi * ruler.radius * ruler.radius;
  const double volume_fraction = total_volume(release) / (base * settled_height);

  CylinderMeasurement measurement;
  measurement.curves = curves_of(series, ruler, volume_fraction);
  measurement.final_profile = radial_depth_profile(end, ruler, volume_fraction);
  const CylinderCurves& curves = measurement.curves;
  const Eigen::VectorXd end_radius = arms(end, ruler).colwise().norm();
  measurement.observables = {
      .runout = curves.front.back() / ruler.radius - 1.0,
      .r90 = volume_quantile(end_radius, end.volumes, 0.90) / ruler.radius,
      .r95 = curves.r95.back() / ruler.radius,
      .mean_radius = curves.mean_radius.back() / ruler.radius,
      .final_height = curves.height.back() / ruler.radius,
      .stop_time = settling_time(curves.time, curves.mean_radius, stop_fraction),
      .roundness = roundness_of(end, ruler, volume_fraction, curves.front.back()),
      .drift = drift_of(end, ruler) / ruler.radius,
      .settled_height = settled_height / ruler.radius,
      .settled_volume_fraction = volume_fraction,
      .lost_volume = 1.0 - total_volume(end) / total_volume(release),
      .at_rest = is_at_rest(curves, ruler),
  };
  return measurement;
}

}  // namespace talus::analysis
