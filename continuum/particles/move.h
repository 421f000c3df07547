// Particle update (section 8 of method.md): FLIP or APIC velocities, shapes, motion through the grid velocity; leaving the
// domain.
#pragma once

#include <span>

#include "continuum/particles/deform.h"
#include "continuum/particles/transfer.h"

namespace talus {

enum class Transfer { flip, apic };

struct Advance {
  double dt;  // s
  Transfer transfer;
  double pic_share;  // with FLIP, in [0, 1]
  bool deforms;      // shapes follow the flow
};

struct AdvanceReport {
  double largest_move = 0.0;  // along any axis, in cells
  DeformReport deform;
};

/// One pass over the particles, with fields that cover all faces:
///   FLIP: v_i += interp(v~ - v^n), blended with interp(v~) by the PIC share
///   APIC (Jiang et al. 2015): v_i = interp(v~), and the particle carries the velocity gradient there
///   x_i += dt v~(x_i), and shapes by equation 5.42 (deform.h)
AdvanceReport advance(const ActiveRegion& region, const PointsByCell& points, const Field& before,
                      const Field& after, const Advance& how, std::span<const Material> materials,
                      Particles& particles);

/// Velocities alone.
void update_velocities_flip(const ActiveRegion& region, const Field& before, const Field& after,
                            double pic_share, Particles& particles);
void update_velocities_apic(const ActiveRegion& region, const Field& after, Particles& particles);

/// Whether dt v~(x_i) exceeds `limit` cells along an axis for a particle.
bool moves_further(const ActiveRegion& region, const PointsByCell& points, const Field& velocity, double dt,
                   const Particles& particles, double limit);

/// Brings positions on periodic axes back into the domain.
void wrap_positions(const Grid& grid, Eigen::Matrix3Xd& positions);

struct Departed {
  Eigen::Index count = 0;
  double mass = 0.0;  // kg
};

/// Takes the particles that are outside the domain out of the simulation; they are counted, never clamped.
Departed remove_departed(const Grid& grid, Particles& particles);

}  // namespace talus
