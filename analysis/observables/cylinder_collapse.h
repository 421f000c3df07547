// What is measured of a cylinder of grains that collapses about its vertical axis, identically for every code. r is measured
// from the axis, z from the floor; all sums are over items, whatever their number or order.
//
//   depth(r)   solid volume above a ring over its area, at the packing phi_0 (binned_depth.h)
//   phi_0      = V / (pi R0^2 H0),  H0 = 2 z_cm: volume fraction of the settled cylinder, at release
//   front      radius at which the depth first falls below front_depth, seen from the axis
//   r_q        the fraction q of the solid volume lies within r_q (less noisy than the front, so reported beside it)
//   stop time  the first time after which the mean radius stays within 1 % of its total change of its end
//   roundness  relative standard deviation of the fronts of eighths of the circle, each from its own depth; 0 for a circle
//
// The innermost ring is small: with bins of a grain's diameter its depth is that of a few grains, and final_height, the
// greatest depth of all rings, is noisy and reads a little high. Bins of two diameters read it well.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "analysis/observables/binned_depth.h"
#include "analysis/snapshot.h"

namespace talus::analysis {

/// What the ruler needs to know of the case. All lengths in metres.
struct CylinderRuler {
  Eigen::Vector2d axis;  // x and y of the vertical axis
  double radius;         // R0, of the released cylinder
  double bin_width;      // dr of the profile
  double front_depth;    // least depth that counts as the heap
};

struct CylinderCurves {
  std::vector<double> time;         // s
  std::vector<double> front;        // m
  std::vector<double> r95;          // m
  std::vector<double> mean_radius;  // m, volume-weighted
  std::vector<double> height;       // m, largest depth
};

/// Lengths are over R0 where the comment says so: those are the figures that are compared.
struct CylinderObservables {
  double runout;                   // (front - R0) / R0 at the end
  double r90, r95;                 // over R0, at the end
  double mean_radius;              // over R0, at the end; 2/3 for a cylinder
  double final_height;             // largest depth over R0, at the end
  double stop_time;                // s
  double roundness;                // at the end
  double drift;                    // of the centre of mass from the axis, horizontal, over R0, at the end
  double settled_height;           // H0 over R0, at release
  double settled_volume_fraction;  // phi_0
  double lost_volume;              // fraction of the released solid volume that is gone at the end
  bool
      at_rest;  // over the last tenth of the time the front moved less than a bin, mean radius and r95 less than 0.002 R0
};

struct CylinderMeasurement {
  CylinderObservables observables;
  CylinderCurves curves;
  DepthProfile final_profile;  // x is the radius
};

/// Throws std::invalid_argument for a broken ruler, SnapshotError when the series is empty, does not start at the release,
/// holds no volume, or when an item is absurdly far away (a leak of the code that made the series).
CylinderMeasurement measure_cylinder_collapse(const SnapshotSeries& series, const CylinderRuler& ruler);

/// Depth by rings of one snapshot.
DepthProfile radial_depth_profile(const Snapshot& snapshot, const CylinderRuler& ruler,
                                  double volume_fraction);

}  // namespace talus::analysis
