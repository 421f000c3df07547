#include "continuum/particles/collide.h"

#include <algorithm>

namespace talus {
namespace {

/// Where walls meet, coming off one can lead into the other.
constexpr int rounds = 4;

/// What the wall takes of a velocity.
Eigen::Vector3d taken_by_wall(const Eigen::Vector3d& velocity, const Eigen::Vector3d& normal,
                              double friction) {
  const double into_wall = -velocity.dot(normal);
  if (into_wall <= 0.0) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d slip = velocity + into_wall * normal;
  const double speed = slip.norm();
  const double stopped = speed > 0.0 ? std::min(1.0, friction * into_wall / speed) : 0.0;
  return -into_wall * normal + stopped * slip;
}

/// As distance_at; outside the domain, by the gradient at the nearest point inside: a wall may stand on its side.
DistanceAndGradient distance_near(const Grid& grid, const Openings& openings,
                                  const Eigen::Vector3d& position) {
  const double inset = 1e-9 * grid.spacing;
  const Eigen::Vector3d inside = position.cwiseMax((grid.origin.array() + inset).matrix())
                                     .cwiseMin((grid.upper().array() - inset).matrix());
  DistanceAndGradient found = distance_at(grid, openings, inside);
  found.distance += found.gradient.dot(position - inside);
  return found;
}

/// Puts a particle back on the wall it is in, calling touch(normal, cell) at each wall it comes off; returns how far it
/// moved, m.
template <class Touch>
double put_back(const Grid& grid, const Openings& openings, Particles& particles, Eigen::Index p,
                Touch&& touch) {
  double moved = 0.0;
  for (int round = 0; round < rounds; ++round) {
    const Eigen::Vector3d position = particles.positions.col(p);
    const auto [distance, gradient] = distance_near(grid, openings, position);
    if (distance >= 0.0 || gradient.squaredNorm() == 0.0) break;
    const Eigen::Vector3d normal = gradient.normalized();
    const Eigen::Vector3i cell =
        grid.cell_at(position).cwiseMax(0).cwiseMin(grid.cells - Eigen::Vector3i::Ones());
    touch(normal, grid.cell_index(cell));
    // The interpolated distance is not quite a distance; going a little further ends the rounds sooner.
    const double step = -distance / gradient.norm() + 1e-9 * grid.spacing;
    particles.positions.col(p) += step * normal;
    moved += step;
  }
  return moved;
}

}  // namespace

CollisionReport collide_with_walls(const Grid& grid, const Openings& openings, const Eigen::ArrayXd& friction,
                                   Particles& particles) {
  CollisionReport report;
  if (!openings.any()) return report;
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    const double moved = put_back(grid, openings, particles, p, [&](const Eigen::Vector3d& normal, int cell) {
      const double wall = openings.friction[cell];
      const Eigen::Vector3d taken =
          taken_by_wall(particles.velocities.col(p), normal, wall < 0.0 ? friction[p] : wall);
      particles.velocities.col(p) -= taken;
      report.impulse -= particles.masses[p] * taken;
    });
    if (moved > 0.0) ++report.count;
    report.deepest = std::max(report.deepest, moved);
  }
  return report;
}

Eigen::Index keep_out_of_walls(const Grid& grid, const Openings& openings, Particles& particles) {
  Eigen::Index count = 0;
  if (!openings.any()) return count;
  for (Eigen::Index p = 0; p < particles.count(); ++p)
    count += put_back(grid, openings, particles, p, [](const Eigen::Vector3d&, int) {}) > 0.0;
  return count;
}

}  // namespace talus
