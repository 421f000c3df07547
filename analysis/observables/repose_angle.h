// The angle of a slope at rest, from one snapshot, identically for every code.
//
//   s        distance from the crest: along x for a slope that is the same all along y, or the radius for a cone
//   h(s)     height of the free surface over the floor = V(s) / (A(s) phi): the level at which the bin's solid volume runs
//            out at the heap's packing. Neither the number of items nor their size enters it, where the highest item would.
//   phi      given, or the heap's own: the packing at which a heap of the height h(s) has the centre of mass that this one
//            has, phi = sum A D^2 / (2 sum V_i z_i) with D = V(s) / A(s); the items' z over the floor
//   flank    the bins from the first below 80 % of the greatest height outwards, to the last before the first below 20 %
//   angle    atan of the flank's slope, by a robust line (statistics/robust_line.h): single bins that lie off do not turn it
//   error    of the fit: from its covariance. Neighbouring bins share items, so it is about a fifth too small.
//   scatter  the same fit over the same bins for each sector: eighths of the circle, or slices through the thickness
//
// On wholly random points (the most uneven packing there can be) the angle read low by 0.1 to 0.5 degrees while its error was
// 0.6 to 1.2: noise decides which bins end the flank. With an error below 0.3 degrees nothing of that was seen. A heap that is
// not alike all around has an own phi that is too low: see the scatter of the sectors first.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <variant>
#include <vector>

#include "analysis/observables/binned_depth.h"
#include "analysis/snapshot.h"

namespace talus::analysis {

/// A slope that falls away from x = crest; what lies behind the crest is not looked at.
struct PlanarSlope {
  double crest;      // m, x of the crest or of the back wall
  double direction;  // +1: falls towards greater x; -1: towards smaller x
  double
      y_begin;  // m; slices are cut from here through the thickness, which repeats itself where it is periodic
  double thickness;  // m, along y
};

struct ConicalHeap {
  Eigen::Vector2d axis;  // m, x and y of the vertical axis
};

struct ReposeRuler {
  std::variant<PlanarSlope, ConicalHeap> shape;
  double bin_width;                  // m, of s; two grain diameters read real grains well
  double floor_height = 0.0;         // m; items below it have left the heap
  std::optional<double> reach = {};  // m; s where the floor ends; items beyond it have left the heap
  std::optional<double> volume_fraction = {};  // phi; measured from the heap when absent
  int sectors = 8;                             // at least 2
};

/// Angles in radians.
struct ReposeAngle {
  double angle;
  double fit_standard_error;
  std::vector<double> sector_angles;
  double
      sector_deviation;  // of one sector, n - 1 in the denominator; over sqrt(n) it is the error of their mean
  double crest_height;   // m, greatest h
  double flank_begin, flank_end;  // m, places of its first and last bin
  double flank_deviation;         // m, root mean square of h less the line
  double volume_fraction;         // phi, as used
  DepthProfile surface;           // s and h of all bins that lie wholly within reach
};

/// Throws std::invalid_argument for a broken ruler, SnapshotError when no item is on the heap or the flank has fewer than five
/// bins.
ReposeAngle measure_repose_angle(const Snapshot& snapshot, const ReposeRuler& ruler);

}  // namespace talus::analysis
