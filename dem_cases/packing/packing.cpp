#include "dem_cases/packing/packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "continuum/files/checked_table.h"

namespace talus::dem {
namespace {

constexpr double jitter_use =
    0.99;  // of the room a grain has in its lattice cell; the rest keeps it from touching
constexpr double largest_start_speed =
    0.05;  // m/s, each component: breaks the lattice, adds 2 % of the energy of the fall

/// The standard's distributions differ between libraries, its generators do not; so the mapping is ours.
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : bits_(seed) {}
  double operator()(double low, double high) {
    const double unit = static_cast<double>(bits_() >> 11) * 0x1.0p-53;  // [0, 1), all 53 bits of a double
    return low + (high - low) * unit;
  }

 private:
  std::mt19937_64 bits_;
};

struct Sphere {
  Eigen::Vector3d position;
  Eigen::Vector3d velocity;
  double radius;
};

double volume(double radius) { return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius; }

double random_radius(const Grains& grains, Uniform& uniform) {
  return 0.5 * grains.diameter * (1.0 + grains.diameter_spread * uniform(-1.0, 1.0));
}

/// One square layer of grains about a diameter apart, wall to wall. Its holes are too small for any grain of
/// the column.
std::vector<Sphere> make_floor(const Case& column, Uniform& uniform) {
  const double d = column.grains.diameter;
  const auto along = std::max(1L, std::lround(column.geometry.tank_length / d));
  const auto across = std::max(1L, std::lround(column.geometry.thickness / d));
  const double pitch_x = column.geometry.tank_length / static_cast<double>(along);
  const double pitch_y = column.geometry.thickness / static_cast<double>(across);
  std::vector<Sphere> spheres;
  for (long i = 0; i < along; ++i) {
    for (long j = 0; j < across; ++j) {
      const double x = (static_cast<double>(i) + 0.5) * pitch_x;
      const double y = (static_cast<double>(j) + 0.5) * pitch_y;
      spheres.push_back(
          {{x, y, -floor_centre_depth * d}, Eigen::Vector3d::Zero(), random_radius(column.grains, uniform)});
    }
  }
  return spheres;
}

/// Fills a lattice behind the gate from below, each grain at a random place within its own cell, until the
/// solid volume is as near to the wanted one as whole grains come.
std::vector<Sphere> make_column(const Case& column, Uniform& uniform) {
  const Geometry& geometry = column.geometry;
  const double d = column.grains.diameter;
  const double largest = d * (1.0 + column.grains.diameter_spread);
  const auto along = static_cast<long>(geometry.column_length / (1.05 * largest));
  const auto across = static_cast<long>(geometry.thickness / (1.05 * largest));
  if (along < 1 || across < 1) {
    throw InputError(
        fmt::format("{}: [geometry] leaves no room for a lattice of grains of {} m behind the gate; make "
                    "column_length_m or thickness_m larger",
                    column.file.string(), largest));
  }
  const Eigen::Vector3d pitch(geometry.column_length / static_cast<double>(along),
                              geometry.thickness / static_cast<double>(across), 1.05 * largest);
  // Above the crests of the floor's largest grains.
  const double bottom =
      geometry.rough_floor ? std::max(0.0, 0.5 * largest - floor_centre_depth * d) + 0.01 * d : 0.0;

  const double wanted =
      column.protocol.volume_fraction * geometry.column_length * geometry.thickness * geometry.column_height;
  std::vector<Sphere> spheres;
  for (double filled = 0.0;;) {
    const double radius = random_radius(column.grains, uniform);
    if (filled + 0.5 * volume(radius) > wanted) return spheres;
    const auto index = static_cast<long>(spheres.size());
    const long row = index / across;
    const Eigen::Vector3d cell(static_cast<double>(row % along), static_cast<double>(index % across),
                               static_cast<double>(row / along));
    const Eigen::Vector3d room = jitter_use * (0.5 * pitch.array() - radius);
    Eigen::Vector3d position, velocity;
    for (int axis = 0; axis < 3; ++axis) {
      position[axis] = (cell[axis] + 0.5) * pitch[axis] + room[axis] * uniform(-1.0, 1.0);
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

Packing make_packing(const Case& column, std::uint64_t seed) {
  Uniform uniform(seed);
  std::vector<Sphere> spheres;
  if (column.geometry.rough_floor) spheres = make_floor(column, uniform);
  const auto fixed_count = static_cast<Eigen::Index>(spheres.size());
  const std::vector<Sphere> mobile = make_column(column, uniform);
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
