#include "analysis/observables/repose_angle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>

#include "analysis/statistics/ensemble.h"
#include "analysis/statistics/robust_line.h"

namespace talus::analysis {
namespace {

constexpr double flank_top = 0.8;  // of the greatest height
constexpr double flank_foot = 0.2;
constexpr std::size_t flank_bins = 5;

/// The items of the heap as its shape sees them.
struct Heap {
  Eigen::VectorXd distance;  // s
  Eigen::VectorXd height;    // over the floor
  Eigen::VectorXd volume;
  std::vector<int> sector;
};

/// Bins along s; the area is that of all sectors together.
struct Bins {
  std::vector<double> place, area;
};

bool is_positive(double value) { return value > 0.0 && std::isfinite(value); }

void check_ruler(const ReposeRuler& ruler) {
  const auto require = [](bool right, const char* what) {
    if (!right) throw std::invalid_argument(fmt::format("ReposeRuler: {}", what));
  };
  require(is_positive(ruler.bin_width), "bin_width must be positive");
  require(std::isfinite(ruler.floor_height), "floor_height must be finite");
  require(!ruler.reach || is_positive(*ruler.reach), "reach must be positive");
  require(!ruler.volume_fraction || (is_positive(*ruler.volume_fraction) && *ruler.volume_fraction <= 1.0),
          "volume_fraction must be in (0, 1]");
  require(ruler.sectors >= 2, "sectors must be at least 2");
  if (const auto* slope = std::get_if<PlanarSlope>(&ruler.shape)) {
    require(std::abs(slope->direction) == 1.0, "direction must be +1 or -1");
    require(is_positive(slope->thickness), "thickness must be positive");
    require(std::isfinite(slope->crest) && std::isfinite(slope->y_begin), "crest and y_begin must be finite");
  } else {
    require(std::get<ConicalHeap>(ruler.shape).axis.allFinite(), "axis must be finite");
  }
}

struct Place {
  double distance;
  double turn;  // where among the sectors, in [0, 1) but for whole turns
};

Place place_of(const Eigen::Vector3d& position, const PlanarSlope& slope) {
  return {slope.direction * (position.x() - slope.crest), (position.y() - slope.y_begin) / slope.thickness};
}

Place place_of(const Eigen::Vector3d& position, const ConicalHeap& heap) {
  const Eigen::Vector2d arm = position.head<2>() - heap.axis;
  return {arm.norm(), std::atan2(arm.y(), arm.x()) / (2.0 * std::numbers::pi)};
}

Heap heap_of(const Snapshot& snapshot, const ReposeRuler& ruler) {
  Heap heap{snapshot.volumes, snapshot.volumes, snapshot.volumes, {}};
  Eigen::Index kept = 0;
  for (Eigen::Index item = 0; item < snapshot.volumes.size(); ++item) {
    const Eigen::Vector3d position = snapshot.positions.col(item);
    const Place place = std::visit([&](const auto& shape) { return place_of(position, shape); }, ruler.shape);
    const double height = position.z() - ruler.floor_height;
    if (place.distance < 0.0 || height < 0.0 || (ruler.reach && place.distance > *ruler.reach)) continue;
    heap.distance[kept] = place.distance;
    heap.height[kept] = height;
    heap.volume[kept] = snapshot.volumes[item];
    const double turn = place.turn - std::floor(place.turn);
    // A turn just below a whole one may round up to it.
    heap.sector.push_back(std::min(static_cast<int>(turn * ruler.sectors), ruler.sectors - 1));
    ++kept;
  }
  heap.distance.conservativeResize(kept);
  heap.height.conservativeResize(kept);
  heap.volume.conservativeResize(kept);
  return heap;
}

Bins bins_of(const ReposeRuler& ruler, std::size_t count) {
  if (std::holds_alternative<ConicalHeap>(ruler.shape)) {
    Rings bins = rings(ruler.bin_width, count);
    return {std::move(bins.radius), std::move(bins.area)};
  }
  const double area = ruler.bin_width * std::get<PlanarSlope>(ruler.shape).thickness;
  Bins bins{std::vector<double>(count), std::vector<double>(count, area)};
  for (std::size_t bin = 0; bin < count; ++bin) {
    bins.place[bin] = (static_cast<double>(bin) + 0.5) * ruler.bin_width;
  }
  return bins;
}

/// Solid depth D = V / A of the items of one sector, or of all (sector = -1).
std::vector<double> solid_depth(const Heap& heap, const Bins& bins, const ReposeRuler& ruler, int sector) {
  Eigen::VectorXd volume = heap.volume;
  if (sector >= 0) {
    for (Eigen::Index item = 0; item < volume.size(); ++item) {
      if (heap.sector[static_cast<std::size_t>(item)] != sector) volume[item] = 0.0;
    }
    volume *= ruler.sectors;  // its share of the area
  }
  auto depth = share_by_bins(heap.distance, volume, ruler.bin_width, bins.area.size());
  for (std::size_t bin = 0; bin < depth.size(); ++bin) depth[bin] /= bins.area[bin];
  return depth;
}

double own_volume_fraction(const Heap& heap, const Bins& bins, const std::vector<double>& depth) {
  double squares = 0.0;
  for (std::size_t bin = 0; bin < depth.size(); ++bin) squares += bins.area[bin] * depth[bin] * depth[bin];
  return squares / (2.0 * heap.volume.dot(heap.height));
}

/// First and one past the last bin of the flank.
struct Flank {
  std::size_t begin, end;
  std::size_t count() const { return end - begin; }
};

Flank flank_of(const std::vector<double>& height) {
  const auto top = std::ranges::max_element(height);
  const auto begin = std::find_if(top, height.end(), [&](double h) { return h <= flank_top * *top; });
  const auto end = std::find_if(begin, height.end(), [&](double h) { return h < flank_foot * *top; });
  const Flank flank{static_cast<std::size_t>(begin - height.begin()),
                    static_cast<std::size_t>(end - height.begin())};
  if (flank.count() < flank_bins) {
    throw SnapshotError(
        fmt::format("the flank has {} bins, but {} are needed: take narrower bins, or there is no slope",
                    flank.count(), flank_bins));
  }
  return flank;
}

RobustLine line_along(const Flank& flank, const std::vector<double>& place,
                      const std::vector<double>& height) {
  return fit_robust_line(std::span(place).subspan(flank.begin, flank.count()),
                         std::span(height).subspan(flank.begin, flank.count()));
}

double deviation_from(const RobustLine& line, const Flank& flank, const DepthProfile& surface) {
  double squares = 0.0;
  for (std::size_t bin = flank.begin; bin < flank.end; ++bin) {
    squares += std::pow(surface.depth[bin] - line.intercept - line.slope * surface.x[bin], 2);
  }
  return std::sqrt(squares / static_cast<double>(flank.count()));
}

/// Bins whose hat lies wholly on the floor: what is cut off by the reach reads too low.
std::size_t whole_bins(const ReposeRuler& ruler, std::size_t bins) {
  if (!ruler.reach) return bins;
  return std::min(bins, static_cast<std::size_t>(std::max(0.0, *ruler.reach / ruler.bin_width - 0.5)));
}

}  // namespace

ReposeAngle measure_repose_angle(const Snapshot& snapshot, const ReposeRuler& ruler) {
  check_ruler(ruler);
  const Heap heap = heap_of(snapshot, ruler);
  if (!(heap.volume.dot(heap.height) > 0.0)) {
    throw SnapshotError(fmt::format("at t = {} s nothing lies on the floor of the heap", snapshot.time));
  }
  const Bins bins = bins_of(ruler, bins_to_hold(heap.distance, ruler.bin_width, snapshot.time));
  const auto depth = solid_depth(heap, bins, ruler, -1);

  ReposeAngle result{};
  result.volume_fraction = ruler.volume_fraction.value_or(own_volume_fraction(heap, bins, depth));
  const std::size_t whole = whole_bins(ruler, depth.size());
  for (std::size_t bin = 0; bin < whole; ++bin) {
    result.surface.x.push_back(bins.place[bin]);
    result.surface.depth.push_back(depth[bin] / result.volume_fraction);
  }
  const Flank flank = flank_of(result.surface.depth);
  const RobustLine line = line_along(flank, result.surface.x, result.surface.depth);
  result.angle = std::atan(-line.slope);
  result.fit_standard_error = line.slope_standard_error / (1.0 + line.slope * line.slope);
  for (int sector = 0; sector < ruler.sectors; ++sector) {
    const double slope = line_along(flank, bins.place, solid_depth(heap, bins, ruler, sector)).slope;
    result.sector_angles.push_back(std::atan(-slope / result.volume_fraction));
  }
  result.sector_deviation = ensemble_statistics(result.sector_angles).standard_deviation;
  result.crest_height = *std::ranges::max_element(result.surface.depth);
  result.flank_begin = result.surface.x[flank.begin];
  result.flank_end = result.surface.x[flank.end - 1];
  result.flank_deviation = deviation_from(line, flank, result.surface);
  return result;
}

}  // namespace talus::analysis
