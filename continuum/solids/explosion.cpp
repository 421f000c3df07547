#include "continuum/solids/explosion.h"

#include <algorithm>
#include <limits>

#include "continuum/solids/body_images.h"

namespace talus {
namespace {

Eigen::Vector3d push_at(const Grid& grid, const Explosion& explosion, const Eigen::Vector3d& position) {
  const Eigen::Vector3d offset = nearest_image(grid, position, explosion.centre) - explosion.centre;
  if (offset.norm() > explosion.radius || offset.isZero(0.0)) return Eigen::Vector3d::Zero();
  return explosion.speed * offset.normalized();
}

}  // namespace

void apply_explosion(const Grid& grid, const Explosion& explosion, Particles& particles,
                     std::span<Body> bodies) {
  for (Eigen::Index p = 0; p < particles.count(); ++p)
    particles.velocities.col(p) += push_at(grid, explosion, particles.positions.col(p));
  for (Body& body : bodies) {
    if (std::holds_alternative<Free>(body.motion))
      body.twist.velocity += push_at(grid, explosion, body.pose.position);
  }
}

void apply_explosions(const Grid& grid, std::span<const Explosion> explosions, double after, double until,
                      Particles& particles, std::span<Body> bodies) {
  for (const Explosion& explosion : explosions) {
    if (explosion.time > after && explosion.time <= until)
      apply_explosion(grid, explosion, particles, bodies);
  }
}

double next_explosion(std::span<const Explosion> explosions, double time) {
  double next = std::numeric_limits<double>::infinity();
  for (const Explosion& explosion : explosions) {
    if (explosion.time > time) next = std::min(next, explosion.time);
  }
  return next;
}

}  // namespace talus
