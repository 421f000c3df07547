// What is measured of a discharge through an opening, identically for every code. V(t) is the solid volume of the items
// whose centre lies above the plane of the opening.
//
//   fill       V(t) / V(0)
//   window     from the first snapshot with fill <= most_fill to the last before fill < least_fill
//   rate       W = - grain_density x slope of the least-squares line through (t, V) in the window
//   its error  the window is cut into `blocks` runs of snapshots of equal number; each has its own line, and the
//              standard error is that of the mean of the block rates: s / sqrt(blocks). What reaches from one block into
//              the next is not in it; a trend in the rate is.
//   flatness   rate in the first half of the window's snapshots over that in the second: 1 for a steady discharge
//   emptied    the first time after which V stays within 1 % of the whole discharged volume of its end
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "analysis/snapshot.h"

namespace talus::analysis {

/// Where the opening is and what the rate is read from.
struct DischargeRuler {
  Eigen::Vector3d opening;  // m, any point of the opening's plane
  Eigen::Vector3d upward =
      Eigen::Vector3d(0.0, 0.0, 1.0);  // normal of the plane, into the reservoir; any length
  double grain_density;                // kg/m^3, of the solid
  double most_fill = 0.9;              // the window, in shares of the volume at release
  double least_fill = 0.3;
  int blocks = 5;  // for the standard error; at least 3, each of at least 3 snapshots
};

struct DischargeCurve {
  std::vector<double> time;    // s
  std::vector<double> volume;  // m^3, solid, above the opening
  std::vector<double> mass;    // kg
};

struct DischargeObservables {
  double rate;                      // kg/s, over the window; positive for an outflow
  double rate_standard_error;       // kg/s
  double flatness;                  // 1
  double window_start, window_end;  // s, first and last snapshot of the window
  double residual;                  // share of the released volume that is above the opening at the end
  std::optional<double>
      emptied_time;  // s; absent when it still flows: more than 0.2 % in the last tenth of the time
};

struct DischargeMeasurement {
  DischargeObservables observables;
  DischargeCurve curve;
};

/// The curve alone, for series that have no window. Throws std::invalid_argument for a broken ruler, SnapshotError when
/// the series does not start at the release or nothing is above the opening then.
DischargeCurve discharge_curve(const SnapshotSeries& series, const DischargeRuler& ruler);

/// Throws as discharge_curve, and SnapshotError when the reservoir never drains to most_fill (it does not flow) or to
/// least_fill (it clogs, or the series ends too soon), or when the window holds fewer than three snapshots a block.
DischargeMeasurement measure_discharge(const SnapshotSeries& series, const DischargeRuler& ruler);

}  // namespace talus::analysis
