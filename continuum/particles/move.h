// Particle update (section 8 of method.md): FLIP velocities, motion through the grid velocity, leaving the
// domain.
#pragma once

#include "continuum/particles/transfer.h"

namespace talus {

/// v_i += interp(v~ - v^n), blended with interp(v~) by `pic_share` in [0, 1]. Fields cover all faces.
void update_velocities(const ActiveRegion& region, const Field& before, const Field& after, double pic_share,
                       Particles& particles);

/// x_i += dt v~(x_i), forward Euler; returns the largest move along an axis, m. Periodic axes wrap.
double move_particles(const ActiveRegion& region, const Field& velocity, double dt, Particles& particles);

/// Brings positions on periodic axes back into the domain.
void wrap_positions(const Grid& grid, Eigen::Matrix3Xd& positions);

struct Departed {
  Eigen::Index count = 0;
  double mass = 0.0;  // kg
};

/// Takes the particles that are outside the domain out of the simulation; they are counted, never clamped.
Departed remove_departed(const Grid& grid, Particles& particles);

}  // namespace talus
