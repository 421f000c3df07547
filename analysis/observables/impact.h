// What is measured of a sphere that falls on a level bed, identically for every code. z is measured from the bed's floor.
//
//   surface     = 2 z_cm of the bed at the release: where a bed of even packing ends, whatever its grains' size
//   depth(t)    = surface - lowest point of the sphere
//   contact     : the moment at which the lowest point goes through the surface; times count from there, linear between rows
//   stop time   : from contact until the sphere first falls more slowly than at 5 % of its speed at contact; what is left is 0.25 %
//                 of the energy, and neither a rebound nor the bed's later creep counts
//   profile(r)  = V(r) / (ring area phi_0) about the axis at the end, phi_0 = V / (side^2 surface): the crater. The room that
//                 the sphere takes counts as empty.
#pragma once

#include <vector>

#include "analysis/body_track.h"
#include "analysis/observables/binned_depth.h"
#include "analysis/snapshot.h"

namespace talus::analysis {

/// What the ruler needs to know of the case, m. The bed is a square about the z axis.
struct ImpactRuler {
  double sphere_radius;
  double side;       // of the bed
  double bin_width;  // dr of the profile
};

struct ImpactObservables {
  double penetration_depth;        // m, at the end
  double stop_time;                // s
  double contact_speed;            // m/s, downwards
  double settled_height;           // m, the surface
  double settled_volume_fraction;  // of the bed at the release
  double lost_volume;              // fraction of the bed that is gone at the end
  bool at_rest;  // over the last tenth of the time the sphere moved by no more than 1 % of its diameter
};

/// At the rows' interval from contact (0) on, over nine tenths of the record, so that all codes' curves end alike.
struct ImpactCurves {
  std::vector<double> time;   // s
  std::vector<double> depth;  // m
  std::vector<double> speed;  // m/s, downwards
};

struct Impact {
  ImpactObservables observables;
  ImpactCurves curves;
  DepthProfile final_profile;  // rings that lie wholly in the bed
};

/// Throws SnapshotError when the series is empty, the sphere starts below the surface, does not reach it within a tenth of the
/// record, or does not stop.
Impact measure_impact(const SnapshotSeries& series, const BodyTrack& track, const ImpactRuler& ruler);

}  // namespace talus::analysis
