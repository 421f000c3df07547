// Sums over the items of a snapshot, weighted by solid volume: what every ruler starts from. Half of an item's own volume
// counts as behind it in a quantile, so neither the number of items nor their order matters.
#pragma once

#include "analysis/snapshot.h"

namespace talus::analysis {

/// Solid volume of all items, m^3.
double total_volume(const Snapshot& snapshot);

/// Throws SnapshotError, naming the time, when the snapshot holds no volume.
void require_volume(const Snapshot& snapshot);

/// Throws SnapshotError when the series is empty, does not start at the release (t = 0), or holds no volume then.
void require_release(const SnapshotSeries& series);

/// Mean of one value per item, weighted by `volumes`; the total must be positive.
double volume_mean(const Eigen::VectorXd& values, const Eigen::VectorXd& volumes);

/// The value below which the fraction q in (0, 1) of the volume lies; between items the volume is linear in the value, and
/// items at the same value count as one. `values` and `volumes` are of one size, not empty, the total is positive.
/// Throws std::invalid_argument for another q.
double volume_quantile(const Eigen::VectorXd& values, const Eigen::VectorXd& volumes, double q);

}  // namespace talus::analysis
