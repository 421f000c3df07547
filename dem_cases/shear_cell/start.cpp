#include "dem_cases/shear_cell/start.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem_cases/packing/uniform.h"

namespace talus::dem {
namespace {

constexpr double lattice_pitch = 1.25;   // mean diameters: the largest grain and room to jitter
constexpr double jitter_use = 0.99;      // of that room; the rest keeps grains from touching
constexpr double largest_speed = 0.05;   // m/s, each component: breaks the lattice
constexpr double wall_roughness = 0.4;   // mean diameters, up and down
constexpr double wall_clearance = 0.95;  // mean diameters, from a wall's plane to the lattice's first cells

ShearStart empty_start(std::uint64_t seed, const Eigen::Vector3d& size, Eigen::Index wall_count,
                       Eigen::Index free_count) {
  const Eigen::Index count = 2 * wall_count + free_count;
  return {.seed = seed,
          .size = size,
          .wall_count = wall_count,
          .positions = Eigen::Matrix3Xd::Zero(3, count),
          .velocities = Eigen::Matrix3Xd::Zero(3, count),
          .radii = Eigen::VectorXd::Zero(count)};
}

void fill_lattice(const Grains& grains, const Eigen::Vector3i& lattice, double bottom, Uniform& uniform,
                  ShearStart& start) {
  const double pitch = lattice_pitch * grains.diameter;
  Eigen::Index sphere = 2 * start.wall_count;
  for (int k = 0; k < lattice.z(); ++k) {
    for (int i = 0; i < lattice.x(); ++i) {
      for (int j = 0; j < lattice.y(); ++j, ++sphere) {
        const double radius = 0.5 * grains.diameter * (1.0 + grains.diameter_spread * uniform(-1.0, 1.0));
        const double room = jitter_use * (0.5 * pitch - radius);
        const Eigen::Vector3d lattice_cell(i, j, k);
        for (int axis = 0; axis < 3; ++axis) {
          start.positions(axis, sphere) = (lattice_cell[axis] + 0.5) * pitch + room * uniform(-1.0, 1.0);
          start.velocities(axis, sphere) = largest_speed * uniform(-1.0, 1.0);
        }
        start.positions(2, sphere) += bottom;
        start.radii[sphere] = radius;
      }
    }
  }
}

/// Up and down in turn, like an egg tray: its pockets hold a grain, and no grain fits through between them.
void fill_walls(const Grains& grains, int along, int across, ShearStart& start) {
  Eigen::Index sphere = 0;
  for (const double plane : {0.0, start.size.z()}) {
    for (int i = 0; i < along; ++i) {
      for (int j = 0; j < across; ++j, ++sphere) {
        start.positions.col(sphere) << (i + 0.5) * start.size.x() / along,
            (j + 0.5) * start.size.y() / across,
            plane + wall_roughness * grains.diameter * ((i + j) % 2 == 0 ? 1.0 : -1.0);
        start.radii[sphere] = 0.5 * grains.diameter;
      }
    }
  }
}

}  // namespace

double ShearStart::free_volume() const {
  return 4.0 / 3.0 * std::numbers::pi * radii.tail(count() - 2 * wall_count).array().cube().sum();
}

ShearStart make_periodic_start(const ShearCell& cell, std::uint64_t seed) {
  Uniform uniform(seed);
  const Eigen::Vector3i& lattice = cell.biaxial.lattice;
  const Eigen::Vector3d size = lattice_pitch * cell.grains.diameter * lattice.cast<double>();
  ShearStart start = empty_start(seed, size, 0, lattice.prod());
  fill_lattice(cell.grains, lattice, 0.0, uniform, start);
  return start;
}

ShearStart make_walled_start(const ShearCell& cell, std::uint64_t seed) {
  Uniform uniform(seed);
  const double d = cell.grains.diameter;
  const Eigen::Vector3i& lattice = cell.simple_shear.lattice;
  Eigen::Vector3d size = lattice_pitch * d * lattice.cast<double>();
  size.z() += 2.0 * wall_clearance * d;
  // Even numbers, so that up and down go on in turn across the periodic boundary.
  const int along = 2 * static_cast<int>(std::lround(0.5 * size.x() / d));
  const int across = 2 * static_cast<int>(std::lround(0.5 * size.y() / d));
  ShearStart start = empty_start(seed, size, static_cast<Eigen::Index>(along) * across, lattice.prod());
  fill_walls(cell.grains, along, across, start);
  fill_lattice(cell.grains, lattice, wall_clearance * d, uniform, start);
  return start;
}

}  // namespace talus::dem
