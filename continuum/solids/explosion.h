// Explosions: an outward push, once, to all that is in a sphere.
#pragma once

#include <Eigen/Core>
#include <span>

#include "continuum/grid/grid.h"
#include "continuum/particles/particles.h"
#include "continuum/solids/body.h"

namespace talus {

struct Explosion {
  double time;             // s
  Eigen::Vector3d centre;  // m
  double radius;           // m
  double speed;            // m/s
};

/// Adds `speed`, straight away from the centre, to the velocity of every particle whose position and every free body whose centre
/// of mass lies in the sphere or, over a periodic seam, in an image of it; nothing to what is at the centre itself. Momentum comes from nowhere, as much to each side as
/// the mass there.
void apply_explosion(const Grid& grid, const Explosion& explosion, Particles& particles,
                     std::span<Body> bodies);

/// Applies those of after < time <= until. Times do not change on the way: a step that ends at next_explosion has it.
void apply_explosions(const Grid& grid, std::span<const Explosion> explosions, double after, double until,
                      Particles& particles, std::span<Body> bodies);

/// When the next one comes after `time`, s; infinite when none does.
double next_explosion(std::span<const Explosion> explosions, double time);

}  // namespace talus
