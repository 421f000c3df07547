#include "validation/pictures.h"

#include <openssl/evp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>

#include "analysis/coarse_graining/coarse_graining.h"

namespace talus::validation {
namespace {

using analysis::Snapshot;
using analysis::SnapshotSeries;
using nlohmann::json;

void check(const SnapshotSeries& series, const PictureOptions& options) {
  const auto require = [](bool good, const char* what) {
    if (!good) throw std::invalid_argument(std::string("picture_of_series: ") + what);
  };
  require(!series.empty() && series.front().volumes.size() > 0, "the series is empty");
  require(options.moments >= 2 && options.items >= 1, "needs at least two moments and one item");
  require(options.field_spacing > 0.0, "field_spacing must be positive");
  require(options.slice_half_width ? *options.slice_half_width > 0.0 : options.thickness > 0.0,
          "thickness or slice_half_width must be positive");
  require(!options.packing || (*options.packing > 0.0 && *options.packing <= 1.0),
          "packing must lie in (0, 1]");
}

std::size_t nearest_frame(const SnapshotSeries& series, double time) {
  const auto closer = [&](const Snapshot& a, const Snapshot& b) {
    return std::abs(a.time - time) < std::abs(b.time - time);
  };
  return static_cast<std::size_t>(std::min_element(series.begin(), series.end(), closer) - series.begin());
}

/// Frames nearest to these shares of the run's length; each once.
std::vector<std::size_t> frames_at(const SnapshotSeries& series, const std::vector<double>& shares) {
  std::vector<std::size_t> frames;
  const double first = series.front().time, length = series.back().time - first;
  for (const double share : shares) frames.push_back(nearest_frame(series, first + share * length));
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

std::vector<double> even_shares(int count) {
  std::vector<double> shares;
  for (int k = 0; k < count; ++k) shares.push_back(static_cast<double>(k) / (count - 1));
  return shares;
}

double thickness_of(const PictureOptions& options) {
  return options.slice_half_width ? 2.0 * *options.slice_half_width : options.thickness;
}

std::vector<Eigen::Index> items_seen(const Snapshot& snapshot, const PictureOptions& options) {
  std::vector<Eigen::Index> seen;
  for (Eigen::Index i = 0; i < snapshot.volumes.size(); ++i) {
    if (!options.slice_half_width || std::abs(snapshot.positions(1, i)) < *options.slice_half_width) {
      seen.push_back(i);
    }
  }
  return seen;
}

/// Every 1/share-th item by its place in the list of all, so that the choice is the same at every moment.
bool is_drawn(Eigen::Index item, double share) {
  return std::floor(static_cast<double>(item + 1) * share) > std::floor(static_cast<double>(item) * share);
}

/// Discs that only share out the area leave gaps wherever the items are not in a lattice.
constexpr double disc_overlap = 1.5;

/// The numbers of one moment that are drawn.
struct Moment {
  double time = 0.0;
  std::size_t count = 0;
  std::vector<double> x, z, radius, start_x, speed;
};

Moment moment_of(const Snapshot& snapshot, const Eigen::VectorXd& start_x, const PictureOptions& options,
                 double share) {
  const auto seen = items_seen(snapshot, options);
  Moment moment;
  moment.time = snapshot.time;
  moment.count = seen.size();
  for (const Eigen::Index i : seen) {
    if (!is_drawn(i, share)) continue;
    // Those that are drawn also cover the area of those that are not.
    const double volume = snapshot.volumes[i];
    moment.radius.push_back(
        options.packing ? std::sqrt(disc_overlap * volume /
                                    (*options.packing * thickness_of(options) * std::numbers::pi * share))
                        : std::cbrt(0.75 * volume / std::numbers::pi));
    moment.x.push_back(snapshot.positions(0, i));
    moment.z.push_back(snapshot.positions(2, i));
    moment.start_x.push_back(start_x[i]);
    moment.speed.push_back(snapshot.velocities.col(i).norm());
  }
  return moment;
}

struct Span {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void include(const std::vector<double>& values) {
    for (const double value : values) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  json as_json() const { return low <= high ? json{low, high} : json{0.0, 0.0}; }
};

std::string base64(const std::vector<unsigned char>& bytes) {
  std::string text(4 * ((bytes.size() + 2) / 3) + 1, '\0');  // EVP_EncodeBlock ends it with a zero
  text.resize(static_cast<std::size_t>(EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                                                       bytes.data(), static_cast<int>(bytes.size()))));
  return text;
}

/// Each value in `size` bytes; all of them lie within the span.
std::string packed(const std::vector<double>& values, const Span& span, int size) {
  const double levels = size == 2 ? 65535.0 : 255.0;
  const double length = span.high - span.low;
  std::vector<unsigned char> bytes;
  for (const double value : values) {
    const auto level =
        static_cast<unsigned>(length > 0.0 ? std::lround(levels * (value - span.low) / length) : 0);
    bytes.push_back(static_cast<unsigned char>(level & 0xffu));
    if (size == 2) bytes.push_back(static_cast<unsigned char>(level >> 8u));
  }
  return base64(bytes);
}

/// Moments packed over ranges that they share.
void pack_moments(const std::vector<Moment>& moments, json& picture) {
  Span x, z, radius{0.0, 0.0}, start_x, speed{0.0, 0.0};
  for (const auto& moment : moments) {
    x.include(moment.x);
    z.include(moment.z);
    radius.include(moment.radius);
    start_x.include(moment.start_x);
    speed.include(moment.speed);
  }
  picture["ranges"] = {{"x", x.as_json()},
                       {"z", z.as_json()},
                       {"radius", radius.as_json()},
                       {"start_x", start_x.as_json()},
                       {"speed", speed.as_json()}};
  picture["moments"] = json::array();
  for (const auto& moment : moments) {
    picture["moments"].push_back({{"time", moment.time},
                                  {"count", moment.count},
                                  {"x", packed(moment.x, x, 2)},
                                  {"z", packed(moment.z, z, 2)},
                                  {"radius", packed(moment.radius, radius, 1)},
                                  {"start_x", packed(moment.start_x, start_x, 1)},
                                  {"speed", packed(moment.speed, speed, 1)}});
  }
}

/// What the options let see, as a snapshot of its own.
Snapshot only_seen(const Snapshot& snapshot, const PictureOptions& options) {
  const auto seen = items_seen(snapshot, options);
  return {snapshot.time, snapshot.positions(Eigen::all, seen), snapshot.velocities(Eigen::all, seen),
          snapshot.volumes(seen)};
}

/// The first whole number of spacings at or beyond everything; a wall at zero stays the grid's own edge, as the kernel is
/// folded there.
analysis::CoarseGrid grid_around(const std::vector<Snapshot>& snapshots, const PictureOptions& options) {
  const double spacing = options.field_spacing;
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const auto& snapshot : snapshots) {
    if (snapshot.volumes.size() == 0) continue;
    low = low.cwiseMin(snapshot.positions.rowwise().minCoeff());
    high = high.cwiseMax(snapshot.positions.rowwise().maxCoeff());
  }
  analysis::CoarseGrid grid;
  grid.spacing = {spacing, thickness_of(options), spacing};
  grid.edges = {analysis::Edge::wall, analysis::Edge::periodic, analysis::Edge::wall};
  grid.origin.y() = -0.5 * thickness_of(options);
  grid.cells[1] = 1;
  for (const int axis : {0, 2}) {
    const auto first = std::floor(low[axis] / spacing), last = std::floor(high[axis] / spacing) + 1.0;
    grid.origin[axis] = first * spacing;
    grid.cells[axis] = static_cast<int>(last - first);
  }
  return grid;
}

json fields_of(const SnapshotSeries& series, const PictureOptions& options) {
  std::vector<Snapshot> snapshots;
  for (const std::size_t frame : frames_at(series, options.field_times)) {
    snapshots.push_back(only_seen(series[frame], options));
    if (snapshots.back().volumes.size() == 0) snapshots.pop_back();
  }
  if (snapshots.empty()) return nullptr;
  const auto grid = grid_around(snapshots, options);
  constexpr double any_density = 1.0;  // neither the volume fraction nor the velocity depends on it
  std::vector<std::vector<double>> fractions, speeds;
  Span fraction_span{0.0, 1.0}, speed_span{0.0, 0.0};
  for (const auto& snapshot : snapshots) {
    const auto fields = analysis::coarse_grain(snapshot, any_density, {}, grid, analysis::Hat{});
    fractions.emplace_back(fields.volume_fraction.begin(), fields.volume_fraction.end());
    auto& speed = speeds.emplace_back();
    for (Eigen::Index cell = 0; cell < grid.count(); ++cell) {
      speed.push_back(fields.density[cell] > 0.0 ? fields.velocity.col(cell).norm() : 0.0);
    }
    fraction_span.include(fractions.back());
    speed_span.include(speed);
  }
  json out{{"origin", {grid.origin.x(), grid.origin.z()}},
           {"spacing", options.field_spacing},
           {"cells", {grid.cells[0], grid.cells[2]}},
           {"ranges", {{"volume_fraction", fraction_span.as_json()}, {"speed", speed_span.as_json()}}}};
  for (std::size_t k = 0; k < snapshots.size(); ++k) {
    out["moments"].push_back({{"time", snapshots[k].time},
                              {"volume_fraction", packed(fractions[k], fraction_span, 1)},
                              {"speed", packed(speeds[k], speed_span, 1)}});
  }
  return out;
}

/// Whether item i of `next` can be item i of `before` for every i. Along y items may have gone round a periodic box.
bool same_items(const Snapshot& before, const Snapshot& next) {
  if (before.volumes.size() != next.volumes.size()) return false;
  const double lapse = next.time - before.time;
  for (Eigen::Index i = 0; i < next.volumes.size(); ++i) {
    const double moved = std::hypot(next.positions(0, i) - before.positions(0, i),
                                    next.positions(2, i) - before.positions(2, i));
    const double allowed = lapse * (before.velocities.col(i).norm() + next.velocities.col(i).norm()) +
                           std::cbrt(next.volumes[i]);
    if (moved > allowed || before.volumes[i] != next.volumes[i]) return false;
  }
  return true;
}

Eigen::VectorXd handed_on(const Snapshot& before, const Eigen::VectorXd& labels, const Snapshot& next) {
  if (same_items(before, next)) return labels;
  if (before.volumes.size() == 0) return next.positions.row(0);  // what has come in starts here
  using Tree = nanoflann::KDTreeEigenMatrixAdaptor<analysis::Vectors, 3, nanoflann::metric_L2_Simple, false>;
  const Tree tree(3, before.positions);
  Eigen::VectorXd result(next.volumes.size());
  for (Eigen::Index i = 0; i < next.volumes.size(); ++i) {
    const Eigen::Vector3d origin = next.positions.col(i) - (next.time - before.time) * next.velocities.col(i);
    Eigen::Index found = 0;
    double distance = 0.0;
    tree.query(origin.data(), 1, &found, &distance);
    result[i] = labels[found];
  }
  return result;
}

}  // namespace

std::vector<Eigen::VectorXd> start_positions(const SnapshotSeries& series) {
  std::vector<Eigen::VectorXd> all;
  for (std::size_t k = 0; k < series.size(); ++k) {
    all.push_back(k == 0 ? Eigen::VectorXd(series[0].positions.row(0))
                         : handed_on(series[k - 1], all.back(), series[k]));
  }
  return all;
}

json picture_of_series(const SnapshotSeries& series, const PictureOptions& options) {
  check(series, options);
  const auto frames = frames_at(series, even_shares(options.moments));
  const auto starts = start_positions(series);
  std::size_t most = 1;
  for (const std::size_t frame : frames) most = std::max(most, items_seen(series[frame], options).size());
  const double share = std::min(1.0, static_cast<double>(options.items) / static_cast<double>(most));
  std::vector<Moment> moments;
  for (const std::size_t frame : frames) {
    moments.push_back(moment_of(series[frame], starts[frame], options, share));
  }
  json picture{{"name", options.name}, {"code", options.code}, {"seed", options.seed}};
  pack_moments(moments, picture);
  picture["fields"] = fields_of(series, options);
  return picture;
}

}  // namespace talus::validation
