// Particle update (section 8 of method.md): FLIP velocities, motion through the grid velocity, leaving the
// domain.
#pragma once

#include "continuum/particles/transfer.h"

namespace talus {

/// FLIP: v_i += interp(v~ - v^n), blended with interp(v~) by `pic_share` in [0, 1]. Fields cover all faces.
void update_velocities_flip(const ActiveRegion& region, const Field& before, const Field& after,
                            double pic_share, Particles& particles);
/// APIC (Jiang et al. 2015): v_i = interp(v~), and the particle carries the velocity gradient there.
void update_velocities_apic(const ActiveRegion& region, const Field& after, Particles& particles);

/// dt v~(x_i): how far forward Euler moves each particle, 3 x n, m.
Eigen::Matrix3Xd moves_of(const ActiveRegion& region, const Field& velocity, double dt,
                          const Particles& particles);
/// The largest of them along any axis, in cells.
double largest_move(const Grid& grid, const Eigen::Matrix3Xd& moves);

/// Brings positions on periodic axes back into the domain.
void wrap_positions(const Grid& grid, Eigen::Matrix3Xd& positions);

struct Departed {
  Eigen::Index count = 0;
  double mass = 0.0;  // kg
};

/// Takes the particles that are outside the domain out of the simulation; they are counted, never clamped.
Departed remove_departed(const Grid& grid, Particles& particles);

}  // namespace talus
