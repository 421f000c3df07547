#include "dem_cases/packing/packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "continuum/files/checked_table.h"
#include "dem_cases/container.h"
#include "dem_cases/packing/uniform.h"

namespace talus::dem {
namespace {

constexpr double jitter_use =
    0.99;  // of the room a grain has in its lattice cell; the rest keeps it from touching
constexpr double largest_start_speed =
    0.05;  // m/s, each component: breaks the lattice, adds 2 % of the energy of the fall

struct Sphere {
  Eigen::Vector3d position;
  Eigen::Vector3d velocity;
  double radius;
};

double volume(double radius) { return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius; }

double random_radius(const Grains& grains, Uniform& uniform) {
  return 0.5 * grains.diameter * (1.0 + grains.diameter_spread * uniform(-1.0, 1.0));
}

/// A rectangle of floor, z = 0.
struct Floor {
  double x_lower, x_upper, y_lower, y_upper;
  bool exact_ends = false;  // the grains at its ends in x reach exactly to them
};

std::vector<Floor> floors_of(const Geometry& geometry) {
  const auto square = [](double side) {
    return std::vector<Floor>{{-0.5 * side, 0.5 * side, -0.5 * side, 0.5 * side}};
  };
  if (const auto* g = std::get_if<ColumnGeometry>(&geometry)) {
    if (!g->rough_floor) return {};
    return {{0.0, g->tank_length, 0.0, g->thickness}};
  }
  if (const auto* g = std::get_if<CylinderGeometry>(&geometry)) return square(g->floor_side);
  if (const auto* g = std::get_if<HeapGeometry>(&geometry)) return square(g->floor_side);
  if (const auto* g = std::get_if<ImpactGeometry>(&geometry)) return square(g->side);
  if (const auto* g = std::get_if<LedgeGeometry>(&geometry))
    return {{0.0, g->length, 0.0, g->thickness, true}};
  if (const auto* g = std::get_if<SlotGeometry>(&geometry)) {
    const double left = 0.5 * (g->width - g->opening), right = 0.5 * (g->width + g->opening);
    return {{0.0, left, 0.0, g->thickness, true}, {right, g->width, 0.0, g->thickness, true}};
  }
  return {};
}

/// One square layer of grains about a diameter apart, wall to wall. Its holes are too small for any grain of
/// the fill.
void add_floor(const Floor& floor, const Grains& grains, Uniform& uniform, std::vector<Sphere>& spheres) {
  const double d = grains.diameter;
  const double length = floor.x_upper - floor.x_lower, width = floor.y_upper - floor.y_lower;
  const auto along = std::max(1L, std::lround(length / d)), across = std::max(1L, std::lround(width / d));
  const double pitch_x = length / static_cast<double>(along), pitch_y = width / static_cast<double>(across);
  for (long i = 0; i < along; ++i) {
    const bool at_end = i == 0 || i == along - 1;
    for (long j = 0; j < across; ++j) {
      const double x = floor.x_lower + (static_cast<double>(i) + 0.5) * pitch_x;
      const double y = floor.y_lower + (static_cast<double>(j) + 0.5) * pitch_y;
      const double radius = random_radius(grains, uniform);
      spheres.push_back({{x, y, -floor_centre_depth * d},
                         Eigen::Vector3d::Zero(),
                         floor.exact_ends && at_end ? 0.5 * pitch_x : radius});
    }
  }
}

/// Where the fill starts: a box that is open at its top, and what of it lies within the container.
struct FillRegion {
  Eigen::Vector2d lower, upper;                       // m, of the box
  std::function<bool(const Eigen::Vector3d&)> holds;  // a point of the box
};

FillRegion within_radius(double radius) {
  return {{-radius, -radius}, {radius, radius}, [=](const Eigen::Vector3d& point) {
            return point.head<2>().norm() <= radius * std::cos(std::numbers::pi / shell_segments);
          }};
}

FillRegion fill_region(const Geometry& geometry) {
  const auto everywhere = [](const Eigen::Vector3d&) { return true; };
  const auto box = [&](double length, double thickness) {
    return FillRegion{{0.0, 0.0}, {length, thickness}, everywhere};
  };
  if (const auto* g = std::get_if<ColumnGeometry>(&geometry)) return box(g->column_length, g->thickness);
  if (const auto* g = std::get_if<SlotGeometry>(&geometry)) return box(g->width, g->thickness);
  if (const auto* g = std::get_if<LedgeGeometry>(&geometry)) return box(g->length, g->thickness);
  if (const auto* g = std::get_if<CylinderGeometry>(&geometry)) return within_radius(g->radius);
  if (const auto* g = std::get_if<HeapGeometry>(&geometry)) return within_radius(g->radius);
  if (const auto* g = std::get_if<ImpactGeometry>(&geometry)) {
    const Eigen::Vector2d corner = Eigen::Vector2d::Constant(0.5 * g->side);
    return {-corner, corner, everywhere};
  }
  const auto& g = std::get<HourglassGeometry>(geometry);
  FillRegion region = within_radius(g.bulb_radius);
  region.holds = [g](const Eigen::Vector3d& point) {
    const double share = std::clamp(point.z() / g.cone_height, 0.0, 1.0);
    const double radius = g.throat_radius + (g.bulb_radius - g.throat_radius) * share;
    return point.head<2>().norm() <= radius * std::cos(std::numbers::pi / shell_segments);
  };
  return region;
}

/// A lattice that fills a region from below, a cell to a grain.
class Lattice {
 public:
  Lattice(const Case& a_case, FillRegion region) : region_(std::move(region)) {
    const double largest = a_case.grains.diameter * (1.0 + a_case.grains.diameter_spread);
    const Eigen::Vector2d size = region_.upper - region_.lower;
    along_ = static_cast<long>(size.x() / (1.05 * largest));
    across_ = static_cast<long>(size.y() / (1.05 * largest));
    if (along_ >= 1 && across_ >= 1) {
      pitch_ = {size.x() / static_cast<double>(along_), size.y() / static_cast<double>(across_),
                1.05 * largest};
      lower_ = {region_.lower.x(), region_.lower.y(), 0.0};
    }
    if (along_ < 1 || across_ < 1 || !find_layer()) {
      throw InputError(fmt::format(
          "{}: [geometry] leaves no room for a lattice of grains of {} m in what is to be filled; "
          "make its lengths or thickness_m larger",
          a_case.file.string(), largest));
    }
  }

  const Eigen::Vector3d& pitch() const { return pitch_; }

  /// Centre of the next cell that lies in the region with all its corners.
  Eigen::Vector3d next() {
    while (!holds_cell(next_)) ++next_;
    return centre(next_++);
  }

 private:
  Eigen::Vector3d centre(long index) const {
    const long row = index / across_, layer = row / along_;
    const Eigen::Vector3d cell(static_cast<double>(row % along_), static_cast<double>(index % across_),
                               static_cast<double>(layer));
    return lower_ + ((cell.array() + 0.5) * pitch_.array()).matrix();
  }

  bool holds_cell(long index) const {
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Array3d side(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
      if (!region_.holds(centre(index) + (side * pitch_.array()).matrix())) return false;
    }
    return true;
  }

  /// Whether there is any cell to be had; regions do not end upwards.
  bool find_layer() const {
    constexpr long layers = 200;
    for (long index = 0; index < layers * along_ * across_; ++index) {
      if (holds_cell(index)) return true;
    }
    return false;
  }

  FillRegion region_;
  long along_ = 0, across_ = 0, next_ = 0;
  Eigen::Vector3d pitch_, lower_;
};

/// Fills the lattice, each grain at a random place within its own cell, until the solid volume is as near to the
/// wanted one as whole grains come.
std::vector<Sphere> make_fill(const Case& a_case, bool on_rough_floor, Uniform& uniform) {
  const double d = a_case.grains.diameter, largest = d * (1.0 + a_case.grains.diameter_spread);
  // Above the crests of the floor's largest grains.
  const double bottom =
      on_rough_floor ? std::max(0.0, 0.5 * largest - floor_centre_depth * d) + 0.01 * d : 0.0;
  Lattice lattice(a_case, fill_region(a_case.geometry));
  const double wanted = a_case.protocol.volume_fraction * fill_volume(a_case.geometry);
  std::vector<Sphere> spheres;
  for (double filled = 0.0;;) {
    const double radius = random_radius(a_case.grains, uniform);
    if (filled + 0.5 * volume(radius) > wanted) return spheres;
    Eigen::Vector3d position = lattice.next(), velocity;
    const Eigen::Vector3d room = jitter_use * (0.5 * lattice.pitch().array() - radius);
    for (int axis = 0; axis < 3; ++axis) {
      position[axis] += room[axis] * uniform(-1.0, 1.0);
      velocity[axis] = largest_start_speed * uniform(-1.0, 1.0);
    }
    position.z() += bottom;
    spheres.push_back({position, velocity, radius});
    filled += volume(radius);
  }
}

}  // namespace

double Packing::mobile_volume() const {
  double sum = 0.0;
  for (const double radius : radii.tail(mobile_count())) sum += volume(radius);
  return sum;
}

double Packing::top() const { return (positions.row(2).transpose() + radii).maxCoeff(); }

Packing make_packing(const Case& a_case, std::uint64_t seed) {
  Uniform uniform(seed);
  std::vector<Sphere> spheres;
  for (const Floor& floor : floors_of(a_case.geometry)) add_floor(floor, a_case.grains, uniform, spheres);
  const auto fixed_count = static_cast<Eigen::Index>(spheres.size());
  const std::vector<Sphere> mobile = make_fill(a_case, fixed_count > 0, uniform);
  spheres.insert(spheres.end(), mobile.begin(), mobile.end());

  const auto count = static_cast<Eigen::Index>(spheres.size());
  Packing packing{.seed = seed,
                  .fixed_count = fixed_count,
                  .positions = Eigen::Matrix3Xd(3, count),
                  .velocities = Eigen::Matrix3Xd(3, count),
                  .radii = Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Sphere& sphere = spheres[static_cast<std::size_t>(i)];
    packing.positions.col(i) = sphere.position;
    packing.velocities.col(i) = sphere.velocity;
    packing.radii[i] = sphere.radius;
  }
  return packing;
}

}  // namespace talus::dem
