#include "analysis/observables/binned_depth.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "analysis/snapshot.h"

namespace talus::analysis {
namespace {

constexpr double most_bins = 1e6;

}  // namespace

std::size_t bins_to_hold(const Eigen::VectorXd& places, double width, double time) {
  const double reach = places.size() > 0 ? std::max(0.0, places.maxCoeff()) : 0.0;
  if (reach > most_bins * width) {
    throw SnapshotError(fmt::format("at t = {} s an item is {} m away: it has left the tank", time, reach));
  }
  return static_cast<std::size_t>(reach / width) + 3;
}

std::vector<double> share_by_bins(const Eigen::VectorXd& places, const Eigen::VectorXd& volumes, double width,
                                  std::size_t bins) {
  std::vector<double> shared(bins, 0.0);
  for (Eigen::Index item = 0; item < places.size(); ++item) {
    const double place = std::max(0.0, places[item] / width - 0.5);  // in bins, from the first bin's centre
    const auto bin = static_cast<std::size_t>(place);
    const double share = place - static_cast<double>(bin);
    if (bin < bins) shared[bin] += (1.0 - share) * volumes[item];
    if (bin + 1 < bins) shared[bin + 1] += share * volumes[item];
  }
  return shared;
}

Rings rings(double width, std::size_t bins) {
  // Integrals of the hat times r and r^2, in bins: r_k and r_k^2 + 1/6. The first hat is level over half a bin: 13/24, 5/12.
  Rings rings{std::vector<double>(bins), std::vector<double>(bins)};
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const double centre = static_cast<double>(bin) + 0.5;
    const double first_moment = bin == 0 ? 13.0 / 24.0 : centre;
    const double second_moment = bin == 0 ? 5.0 / 12.0 : centre * centre + 1.0 / 6.0;
    rings.radius[bin] = width * second_moment / first_moment;
    rings.area[bin] = 2.0 * std::numbers::pi * width * width * first_moment;
  }
  return rings;
}

double front_of(const DepthProfile& profile, double front_depth, std::size_t first) {
  const auto start = profile.depth.begin() + static_cast<std::ptrdiff_t>(first);
  const auto edge =
      std::find_if(start, profile.depth.end(), [&](double depth) { return depth < front_depth; });
  if (edge == profile.depth.end()) return profile.x.back();
  const auto low = static_cast<std::size_t>(edge - profile.depth.begin());
  if (low == first) return 0.0;
  const double fall = profile.depth[low - 1] - profile.depth[low];
  return profile.x[low - 1] +
         (profile.x[low] - profile.x[low - 1]) * (profile.depth[low - 1] - front_depth) / fall;
}

}  // namespace talus::analysis
