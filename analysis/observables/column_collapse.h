// What is measured of a column collapse, identically for every code. x is measured from the back wall, z from the floor;
// all sums are over items, whatever their number or order.
//
//   depth(x)  = V(x) / (dx W phi_0)                 solid volume above dx, at the packing phi_0
//   phi_0     = V / (L0 W H0),  H0 = 2 z_cm         volume fraction of the settled column, at release
//   front     = largest x with depth >= front_depth of the heap, the part joined to the back wall
//   x_q       : the fraction q of the solid volume lies behind x_q (quantiles; not noisy, so reported beside the front)
//   stop time : the first time after which the centre of mass stays within 1 % of its total displacement of its end,
//               linear between snapshots
//
// How the volume is shared by bins and what that does to the front: binned_depth.h.
#pragma once

#include <string>
#include <vector>

#include "analysis/observables/binned_depth.h"
#include "analysis/snapshot.h"

namespace talus::analysis {

/// What the ruler needs to know of the case. All lengths in metres.
struct CollapseRuler {
  double column_length;  // L0
  double thickness;      // W
  double bin_width;      // dx of the profile
  double front_depth;    // least depth that counts as the heap
};

struct CollapseCurves {
  std::vector<double> time;            // s
  std::vector<double> front;           // m
  std::vector<double> x95;             // m
  std::vector<double> centre_of_mass;  // m, along x
  std::vector<double> height;          // m, largest depth
};

/// Lengths are over L0 where the comment says so: those are the figures that are compared.
struct CollapseObservables {
  double runout;                   // (front - L0) / L0 at the end
  double x90, x95;                 // over L0, at the end
  double centre_of_mass;           // along x, over L0, at the end
  double final_height;             // largest depth over L0, at the end
  double stop_time;                // s
  double settled_height;           // H0 over L0, at release
  double settled_volume_fraction;  // phi_0
  double lost_volume;              // fraction of the released solid volume that is gone at the end
  bool
      at_rest;  // over the last 10 % of the time the front moved less than a bin, centre of mass and x95 less than
                // 0.002 L0
};

struct CollapseMeasurement {
  CollapseObservables observables;
  CollapseCurves curves;
  DepthProfile final_profile;
};

/// Throws SnapshotError when the series is empty, does not start at the release, holds no volume, or when an
/// item has passed through the back wall or is absurdly far away (both are leaks of the code that made the
/// series).
CollapseMeasurement measure_column_collapse(const SnapshotSeries& series, const CollapseRuler& ruler);

/// Depth profile of one snapshot; each item's volume is shared linearly by the two nearest bins.
DepthProfile depth_profile(const Snapshot& snapshot, const CollapseRuler& ruler, double volume_fraction);

/// The x behind which the fraction q in (0, 1) of the solid volume lies, m. Half of an item's own volume
/// counts as behind it, and between items the volume is linear in x. Throws SnapshotError for a snapshot
/// without volume, std::invalid_argument for another q.
double volume_quantile(const Snapshot& snapshot, double q);

}  // namespace talus::analysis
