#include "continuum/particles/move.h"

#include <cmath>

namespace talus {

void update_velocities(const ActiveRegion& region, const Field& before, const Field& after, double pic_share,
                       Particles& particles) {
  const Eigen::Matrix3Xd gained = interpolate(region, after - before, particles.positions);
  const Eigen::Matrix3Xd on_grid = interpolate(region, after, particles.positions);
  particles.velocities = (1.0 - pic_share) * (particles.velocities + gained) + pic_share * on_grid;
}

double move_particles(const ActiveRegion& region, const Field& velocity, double dt, Particles& particles) {
  const Eigen::Matrix3Xd moved = dt * interpolate(region, velocity, particles.positions);
  particles.positions += moved;
  wrap_positions(region.grid, particles.positions);
  return moved.size() > 0 ? moved.cwiseAbs().maxCoeff() : 0.0;
}

void wrap_positions(const Grid& grid, Eigen::Matrix3Xd& positions) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!grid.periodic[static_cast<std::size_t>(axis)]) continue;
    const double low = grid.origin[axis], length = grid.spacing * grid.cells[axis];
    for (Eigen::Index p = 0; p < positions.cols(); ++p) {
      double offset = positions(axis, p) - low;
      offset -= length * std::floor(offset / length);
      positions(axis, p) = low + (offset < length ? offset : 0.0);
    }
  }
}

Departed remove_departed(const Grid& grid, Particles& particles) {
  Departed departed;
  Eigen::Index kept = 0;
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    if (!grid.holds(grid.cell_at(particles.positions.col(p)))) {
      ++departed.count;
      departed.mass += particles.masses[p];
      continue;
    }
    particles.positions.col(kept) = particles.positions.col(p);
    particles.velocities.col(kept) = particles.velocities.col(p);
    particles.masses[kept] = particles.masses[p];
    particles.materials[static_cast<std::size_t>(kept)] = particles.materials[static_cast<std::size_t>(p)];
    ++kept;
  }
  if (departed.count > 0) {
    particles.positions.conservativeResize(3, kept);
    particles.velocities.conservativeResize(3, kept);
    particles.masses.conservativeResize(kept);
    particles.materials.resize(static_cast<std::size_t>(kept));
  }
  return departed;
}

}  // namespace talus
