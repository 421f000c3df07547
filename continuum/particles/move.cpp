#include "continuum/particles/move.h"

namespace talus {

void update_velocities_flip(const ActiveRegion& region, const Field& before, const Field& after,
                            double pic_share, Particles& particles) {
  const Eigen::Matrix3Xd gained = interpolate(region, after - before, particles.positions);
  const Eigen::Matrix3Xd on_grid = interpolate(region, after, particles.positions);
  particles.velocities = (1.0 - pic_share) * (particles.velocities + gained) + pic_share * on_grid;
}

void update_velocities_apic(const ActiveRegion& region, const Field& after, Particles& particles) {
  particles.velocities = interpolate(region, after, particles.positions);
  particles.gradients = interpolate_gradient(region, after, particles.positions);
}

Eigen::Matrix3Xd moves_of(const ActiveRegion& region, const Field& velocity, double dt,
                          const Particles& particles) {
  return dt * interpolate(region, velocity, particles.positions);
}

double largest_move(const Grid& grid, const Eigen::Matrix3Xd& moves) {
  return moves.size() > 0 ? moves.cwiseAbs().maxCoeff() / grid.spacing : 0.0;
}

void wrap_positions(const Grid& grid, Eigen::Matrix3Xd& positions) {
  for (auto position : positions.colwise()) position = grid.wrapped_position(position);
}

Departed remove_departed(const Grid& grid, Particles& particles) {
  Departed departed;
  Eigen::Index kept = 0;
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    if (!grid.contains(particles.positions.col(p))) {
      ++departed.count;
      departed.mass += particles.masses[p];
      continue;
    }
    particles.copy(p, kept);
    ++kept;
  }
  if (departed.count > 0) particles.resize(kept);
  return departed;
}

}  // namespace talus
