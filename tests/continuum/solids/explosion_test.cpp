// Outward pushes: who gets one, how strong, and when.
#include "continuum/solids/explosion.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>

namespace talus {
namespace {

using Eigen::Vector3d;

const Grid grid{{0, -1, -1}, 0.1, {20, 20, 20}, {false, false, false}};
const Explosion blast{0.5, {1, 0, 0}, 0.4, 3.0};

Particles particles_at(const std::vector<Vector3d>& places) {
  Particles particles;
  particles.resize(static_cast<Eigen::Index>(places.size()));
  for (std::size_t p = 0; p < places.size(); ++p) {
    particles.positions.col(static_cast<Eigen::Index>(p)) = places[p];
    particles.velocities.col(static_cast<Eigen::Index>(p)) = Vector3d(0, 1, 0);
  }
  return particles;
}

TEST(Explosion, PushesWhatIsInTheSphereStraightOutwards) {
  Particles particles = particles_at({{1.3, 0, 0}, {1, 0.03, -0.04}, {1, 0, 0}, {1.41, 0, 0}});
  std::array bodies{
      make_body("in", {Sphere{{1, 0, 0.39}, 0.2}}, 1000.0),
      make_body("out", {Sphere{{1, 0, 0.41}, 0.2}}, 1000.0),
      make_body("hinged", {Sphere{{1, 0, 0.39}, 0.2}}, 1000.0, Hinge{{0, 0, 0}, Vector3d::UnitY()})};
  apply_explosion(grid, blast, particles, bodies);
  EXPECT_LT((particles.velocities.col(0) - Vector3d(3, 1, 0)).norm(), 1e-14);
  EXPECT_LT((particles.velocities.col(1) - Vector3d(0, 1 + 1.8, -2.4)).norm(), 1e-14);
  EXPECT_EQ(particles.velocities.col(2), Vector3d(0, 1, 0));
  EXPECT_EQ(particles.velocities.col(3), Vector3d(0, 1, 0));
  EXPECT_LT((bodies[0].twist.velocity - Vector3d(0, 0, 3)).norm(), 1e-14);
  EXPECT_EQ(bodies[1].twist.velocity, Vector3d::Zero());
  EXPECT_EQ(bodies[2].twist.velocity, Vector3d::Zero());
}

TEST(Explosion, ComesOnceAndInTime) {
  const std::array explosions{blast, Explosion{0.25, {1, 0, 0}, 0.4, 1.0}};
  EXPECT_EQ(next_explosion(explosions, 0.0), 0.25);
  EXPECT_EQ(next_explosion(explosions, 0.25), 0.5);
  EXPECT_EQ(next_explosion(explosions, 0.5), std::numeric_limits<double>::infinity());
  Particles particles = particles_at({{1.3, 0, 0}});
  const auto pushed = [&](double after, double until) {
    const double before = particles.velocities(0, 0);
    apply_explosions(grid, explosions, after, until, particles, {});
    return particles.velocities(0, 0) - before;
  };
  EXPECT_DOUBLE_EQ(pushed(0.0, 0.25), 1.0);
  EXPECT_DOUBLE_EQ(pushed(0.25, 0.4), 0.0);
  EXPECT_DOUBLE_EQ(pushed(0.4, 0.6), 3.0);
  EXPECT_DOUBLE_EQ(pushed(0.0, 1.0), 4.0);
}

}  // namespace
}  // namespace talus
