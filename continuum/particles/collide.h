// Particles that moved into a solid within a step: what the grid cannot stop, because it resolves the wall only to a
// share of each face, and because sand below its packing limit carries no pressure.
//
// The particle is put back on the wall along the wall's normal. The wall takes the normal velocity into it and, by
// friction, at most mu_w times that of the tangential velocity: the impulse R of method.md, section 4, and its bound.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "continuum/grid/openings.h"
#include "continuum/particles/particles.h"
#include "continuum/solids/body.h"

namespace talus {

struct CollisionReport {
  Eigen::Index count = 0;
  double deepest = 0.0;                               // m, the furthest a particle was moved back
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();  // kg m/s, on the sand
  std::vector<Eigen::Matrix<double, 6, 1>>
      on_bodies;  // impulse and angular impulse about its centre of mass, on each

  CollisionReport& operator+=(const CollisionReport& other) {
    count += other.count;
    deepest = std::max(deepest, other.deepest);
    impulse += other.impulse;
    if (on_bodies.empty())
      on_bodies = other.on_bodies;
    else
      for (std::size_t b = 0; b < other.on_bodies.size(); ++b) on_bodies[b] += other.on_bodies[b];
    return *this;
  }
};

/// `friction`: mu of each particle, used where the wall is as rough as the sand. A wall may stand on the domain's side:
/// what went through both is put back, what went through an open side alone is left to leave.
/// A wall that belongs to one of `bodies` (Openings::body) is met with the body's own velocity.
CollisionReport collide_with_walls(const Grid& grid, const Openings& openings, const Eigen::ArrayXd& friction,
                                   Particles& particles, std::span<const Body> bodies = {});

/// Puts back particles that the density correction moved into a wall; their velocities stay. Returns how many.
Eigen::Index keep_out_of_walls(const Grid& grid, const Openings& openings, Particles& particles);

}  // namespace talus
