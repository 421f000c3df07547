// A run reduced to what the report's pictures need: some moments of some of its items, seen from the side, and coarse-grained
// fields of a few moments. Small enough that a report of 25 points by three codes stays below 12 MB.
//
// Packed numbers are unsigned integers q of one or two bytes (low byte first) in base64, with the range they are spread over:
// value = low + (high - low) q / (2^bits - 1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analysis/snapshot.h"

namespace talus::validation {

struct PictureOptions {
  std::string name;  // of the point, "column_collapse/a_1"
  std::string code;  // "liggghts"
  std::uint64_t seed = 1;
  double thickness = 0.0;                  // m, of the slab along y; not used with a slice
  std::optional<double> slice_half_width;  // m: show only what has |y| below it, as in a 3-D heap
  /// Of particles, how much of their bulk volume is solid: each is then drawn as a disc with its share of the area seen from
  /// the side, and half as much again. Without it the items are grains, drawn as the spheres that they are.
  std::optional<double> packing;
  double field_spacing = 0.0;  // m, of the grid of the fields
  int moments = 12;            // evenly in time, the first and the last included
  /// Of each moment, about; the same ones as long as the run's number of items does not change.
  std::size_t items = 800;
  /// Over the run's length; the nearest snapshots are taken. What moves does so early.
  std::vector<double> field_times{0.1, 0.2, 0.35};
};

/// {name, code, seed,
///  ranges: {x, z, radius, start_x (m), speed (m/s): [low, high]},
///  moments: [{time (s), count (items of the moment, those not drawn included), x, z (2 bytes each), radius, start_x, speed (1 byte)}],
///  fields: {origin: [x, z] (m), spacing (m), cells: [along x, along z], ranges: {volume_fraction, speed (m/s)},
///           moments: [{time, volume_fraction, speed: 1 byte for each cell, x fastest}]}}
/// `start_x` is where an item stood in the first snapshot; where items merge, split or leave it is followed from snapshot to
/// snapshot (start_positions). Speeds are of all three components.
/// Throws std::invalid_argument for an empty series or options that make no sense, SnapshotError from the coarse-graining.
nlohmann::json picture_of_series(const analysis::SnapshotSeries& series, const PictureOptions& options);

/// Where the items of each snapshot stood along x in the first one (m). Items carry no names, so: as long as their number stays
/// and none has moved farther than its speed allows, item i is item i; otherwise an item comes from the one nearest to where
/// its velocity says it was. A label may then pass to a neighbour: good for colours, not for measuring.
std::vector<Eigen::VectorXd> start_positions(const analysis::SnapshotSeries& series);

}  // namespace talus::validation
