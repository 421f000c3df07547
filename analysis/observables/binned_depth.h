// Depth by bins along one coordinate: x from a wall, or the radius from an axis. Each item's volume is shared linearly by
// the two nearest bin centres (k + 1/2) width, and wholly by the first within half a bin of the start: a block is exactly
// flat, a slope exactly straight, and splitting an item changes nothing.
//
// A ring's share is its hat function over 2 pi r dr. For a depth that is linear in r the ring's mean depth is the depth at
// the hat's centre of area, so that is the ring's place: r_k + dr^2 / (6 r_k), nearly the bin's centre.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace talus::analysis {

struct DepthProfile {
  std::vector<double> x;      // m, places of the bins; a radius where the bins are rings
  std::vector<double> depth;  // m
};

/// Enough bins that the last is empty, so that every heap has an end. Throws SnapshotError, naming the time (s), when an
/// item lies more than 1e6 bins away: it has escaped.
std::size_t bins_to_hold(const Eigen::VectorXd& places, double width, double time);

/// Volume in each of `bins` bins; what is shared with later bins is left out. Places below 0 count as 0.
std::vector<double> share_by_bins(const Eigen::VectorXd& places, const Eigen::VectorXd& volumes, double width,
                                  std::size_t bins);

struct Rings {
  std::vector<double> radius;  // m, centre of area of the ring's hat
  std::vector<double> area;    // m^2, of the whole circle; a sector has its share of it
};
Rings rings(double width, std::size_t bins);

/// Where the depth first falls below `front_depth`, seen from bin `first` outwards, linear between bins: exact for a slope
/// where front_depth is more than its rise over two bins; a vertical step is smeared over three bins and reads up to 1.5 bins
/// too far. 0 when bin `first` itself is too low, the last place when no bin is.
double front_of(const DepthProfile& profile, double front_depth, std::size_t first = 0);

}  // namespace talus::analysis
