// Particles that went into a wall: where they come back to, and what the wall takes of their velocity.
#include "continuum/particles/collide.h"

#include <gtest/gtest.h>

#include <random>

#include "continuum/particles/move.h"
#include "continuum/solids/body_step.h"
#include "continuum/solids/wall.h"
#include "continuum/step.h"
#include "tests/continuum/particles/particle_sums.h"

namespace talus {
namespace {

using Eigen::Vector3d;

constexpr double h = 0.1;  // m
const Grid grid{{0, 0, 0}, h, {10, 10, 10}, {false, false, false}};
const double on_wall = 1e-8 * h;  // put back this near to the wall, and not into it

Wall plane(const Vector3d& point, const Vector3d& normal, double friction) {
  return {Shape{Plane{point, normal.normalized()}}, friction};
}

Particles one(const Vector3d& position, const Vector3d& velocity, double mass = 2.0) {
  Particles particles;
  testing::add_particle(position, mass, 1e-4 * Eigen::Matrix3d::Identity(), particles);
  particles.velocities.col(0) = velocity;
  return particles;
}

CollisionReport collide(std::initializer_list<Wall> walls, Particles& particles, double friction = 0.5) {
  const Openings openings = openings_of(grid, {walls.begin(), walls.size()}, 0.0);
  return collide_with_walls(grid, openings, Eigen::ArrayXd::Constant(particles.count(), friction), particles);
}

TEST(Collide, BackOntoTheWallAlongItsNormal) {
  const Vector3d normal = Vector3d(1, 2, 4).normalized(), point(0.5, 0.5, 0.52);
  const Vector3d place = point + Vector3d(4, -2, 0).normalized() * 0.13;  // on the wall
  Particles particles = one(place - 0.03 * normal, Vector3d::Zero());
  const CollisionReport report = collide({plane(point, normal, 0.3)}, particles);
  EXPECT_LT((particles.positions.col(0) - place).norm(), on_wall);
  EXPECT_GE(normal.dot(particles.positions.col(0) - point), 0.0);
  EXPECT_EQ(report.count, 1);
  EXPECT_NEAR(report.deepest, 0.03, on_wall);
}

TEST(Collide, WhatIsOutsideStaysUntouched) {
  const Vector3d normal = Vector3d(1, 2, 4).normalized(), point(0.5, 0.5, 0.52);
  Particles particles = one(point + 1e-6 * normal, -normal);
  const Particles before = particles;
  const CollisionReport report = collide({plane(point, normal, 0.3)}, particles);
  EXPECT_TRUE(testing::identical(particles, before));
  EXPECT_EQ(report.count, 0);
  EXPECT_EQ(report.deepest, 0.0);
  EXPECT_EQ(report.impulse, Vector3d::Zero());
}

TEST(Collide, NormalVelocityIsTakenAndSlipLosesFrictionTimesThat) {
  const Vector3d normal = Vector3d(1, 0, 2).normalized(), along = Vector3d(2, 0, -1).normalized(),
                 across = Vector3d::UnitY(), point(0.5, 0.5, 0.5);
  struct Case {
    double mu, sand_mu, into, slip;
  };
  for (const auto& [mu, sand_mu, into, slip] :
       {Case{0.3, 9.0, 2.0, 5.0}, Case{0.3, 9.0, 2.0, 0.5}, Case{0.0, 9.0, 2.0, 5.0},
        Case{0.3, 9.0, 2.0, 0.0}, Case{as_rough_as_sand, 0.7, 2.0, 5.0}}) {
    const Vector3d direction = (along + 0.5 * across).normalized();
    Particles particles = one(point - 0.01 * normal, -into * normal + slip * direction);
    const CollisionReport report = collide({plane(point, normal, mu)}, particles, sand_mu);
    const double left = std::max(0.0, slip - (mu < 0.0 ? sand_mu : mu) * into);
    EXPECT_LT((particles.velocities.col(0) - left * direction).norm(), 1e-12) << mu << ' ' << slip;
    const Vector3d gained = 2.0 * (left * direction - (-into * normal + slip * direction));
    EXPECT_LT((report.impulse - gained).norm(), 1e-12);
  }
}

TEST(Collide, WhatComesOutIsNotSlowed) {
  const Vector3d normal = Vector3d(1, 0, 2).normalized(), point(0.5, 0.5, 0.5);
  const Vector3d velocity = 0.1 * normal + Vector3d(2, 0.5, -1);
  Particles particles = one(point - 0.01 * normal, velocity);
  const CollisionReport report = collide({plane(point, normal, 0.9)}, particles);
  EXPECT_EQ(particles.velocities.col(0), velocity);
  EXPECT_EQ(report.impulse, Vector3d::Zero());
  EXPECT_EQ(report.count, 1);  // it is put back all the same
}

TEST(Collide, WhereTwoWallsMeetTheParticleEndsOutsideBoth) {
  for (const double half_angle_deg : {45.0, 60.0, 75.0}) {
    const double angle = half_angle_deg * M_PI / 180.0;  // between each wall and the upright
    const Vector3d left(std::cos(angle), 0, std::sin(angle)), right(-std::cos(angle), 0, std::sin(angle)),
        valley(0.53, 0.5, 0.42);
    const std::array walls{plane(valley, left, 0.0), plane(valley, right, 0.0)};
    const Openings openings = openings_of(grid, walls, 0.0);
    for (const Vector3d& offset :
         {Vector3d(0, 0, -0.03), Vector3d(0.02, 0, -0.04), Vector3d(-0.05, 0, 0.0)}) {
      Particles particles = one(valley + offset, Vector3d(0.1, 0, -3));
      collide_with_walls(grid, openings, Eigen::ArrayXd::Constant(1, 0.5), particles);
      const Vector3d at = particles.positions.col(0);
      EXPECT_GE(distance_at(grid, openings, at).distance, 0.0)
          << half_angle_deg << ": " << offset.transpose();
      // The interpolated corner is rounder than the true one, by a fraction of a cell.
      EXPECT_GE(nearest_wall(walls, 0.0, at).distance, -0.3 * h);
      EXPECT_LT((at - valley).norm(), h);
    }
  }
}

TEST(Collide, AWallOnTheDomainsSideStopsWhatLeftThroughIt) {
  Particles particles = one({0.55, 0.5, -0.03}, {1.0, 0.0, -2.0});
  const CollisionReport report = collide({plane({0, 0, 0}, Vector3d::UnitZ(), 0.25)}, particles);
  EXPECT_EQ(report.count, 1);
  EXPECT_LT((particles.positions.col(0) - Vector3d(0.55, 0.5, 0.0)).norm(), on_wall);
  EXPECT_LT((particles.velocities.col(0) - Vector3d(0.5, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(remove_departed(grid, particles).count, 0);
}

TEST(Collide, WhatLeavesThroughAnOpenSideIsLeftToLeave) {
  for (const Vector3d& gone :
       {Vector3d(-0.02, 0.5, 0.5), Vector3d(1.03, 0.5, 0.001), Vector3d(0.5, 0.5, 1.2)}) {
    Particles particles = one(gone, {1.0, 0.0, -2.0});
    const Particles before = particles;
    EXPECT_EQ(collide({plane({0, 0, 0}, Vector3d::UnitZ(), 0.25)}, particles).count, 0);
    EXPECT_TRUE(testing::identical(particles, before));
    EXPECT_EQ(remove_departed(grid, particles).count, 1);
  }
  // Through both: off the wall, and still out of the side.
  Particles particles = one({-0.02, 0.5, -0.01}, {-1.0, 0.0, -2.0});
  collide({plane({0, 0, 0}, Vector3d::UnitZ(), 0.0)}, particles);
  EXPECT_LT((particles.positions.col(0) - Vector3d(-0.02, 0.5, 0.0)).norm(), on_wall);
  EXPECT_EQ(remove_departed(grid, particles).count, 1);
}

TEST(Collide, OutOfAThinPlateTheWayIsBack) {
  // As thin as bodies are made for the grid, and turned: half way through it the interpolated distance has hardly a gradient.
  const double half = 0.5 * least_thickness * h;
  Box plate{{0.5, 0.5, 0.5}, {2.0, 2.0, half}};
  plate.rotation =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), Vector3d(0.3, 0.2, 1.0)).toRotationMatrix();
  const Vector3d normal = plate.rotation.col(2);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(0.2, 0.8);
  Particles particles;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d at(unit(random), unit(random), unit(random));
    if (std::abs(normal.dot(at - plate.centre)) < half)
      testing::add_particle(at, 1.0, 1e-4 * Eigen::Matrix3d::Identity(), particles);
  }
  ASSERT_GT(particles.count(), 200);
  const Particles before = particles;
  EXPECT_LT(collide({{Shape{plate}, 0.3}}, particles).deepest, h);
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    const double was = normal.dot(before.positions.col(p) - plate.centre),
                 is = normal.dot(particles.positions.col(p) - plate.centre);
    EXPECT_GT(std::abs(is), 0.7 * half);
    if (std::abs(was) > half - largest_allowed_move * h) {
      EXPECT_EQ(is > 0.0, was > 0.0) << was / half;
    }
  }
}

class Cloud : public ::testing::Test {
 protected:
  Cloud() {
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 600; ++i) {
      const Vector3d at(unit(random), unit(random), unit(random));
      if (nearest_wall(walls_, 0.0, at).distance < -0.5 * h) continue;  // deeper than a step goes
      testing::add_particle(at, 1.0 + unit(random), 1e-4 * Eigen::Matrix3d::Identity(), particles_);
      particles_.velocities.col(particles_.count() - 1) =
          Vector3d(normal(random), normal(random), normal(random));
    }
  }
  std::array<Wall, 2> walls_{plane({0.5, 0.5, 0.4}, {0.3, 0.1, 1}, 0.4),
                             Wall{Shape{Sphere{{0.6, 0.5, 0.78}, 0.25}}, as_rough_as_sand}};
  Openings openings_ = openings_of(grid, walls_, 0.0);
  Particles particles_;
};

TEST_F(Cloud, TheImpulseIsTheChangeOfMomentum) {
  const Vector3d before = particles_.velocities * particles_.masses.matrix();
  const Eigen::ArrayXd energy = particles_.velocities.colwise().squaredNorm().transpose().array();
  const CollisionReport report =
      collide_with_walls(grid, openings_, Eigen::ArrayXd::Constant(particles_.count(), 0.5), particles_);
  const Vector3d after = particles_.velocities * particles_.masses.matrix();
  EXPECT_GT(report.count, 20);
  EXPECT_LT(report.count, particles_.count());
  EXPECT_GT(report.impulse.norm(), 1.0);
  EXPECT_LT((after - before - report.impulse).norm(), 1e-11);
  EXPECT_LE((particles_.velocities.colwise().squaredNorm().transpose().array() - energy).maxCoeff(), 1e-12);
}

TEST_F(Cloud, KeptOutOfWallsTheyKeepTheirVelocities) {
  Particles collided = particles_;
  const Eigen::Index count =
      collide_with_walls(grid, openings_, Eigen::ArrayXd::Constant(particles_.count(), 0.5), collided).count;
  const Eigen::Matrix3Xd velocities = particles_.velocities;
  EXPECT_EQ(keep_out_of_walls(grid, openings_, particles_), count);
  EXPECT_EQ(particles_.velocities, velocities);
  EXPECT_EQ(particles_.positions, collided.positions);
  for (Eigen::Index p = 0; p < particles_.count(); ++p) {
    const Vector3d position = particles_.positions.col(p);
    if (grid.contains(position)) {  // a wall may push them over the domain's side
      EXPECT_GE(distance_at(grid, openings_, position).distance, 0.0);
    }
  }
}

TEST_F(Cloud, WithoutWallsNothingHappens) {
  const Particles before = particles_;
  EXPECT_EQ(collide({}, particles_).count, 0);
  EXPECT_EQ(keep_out_of_walls(grid, Openings{}, particles_), 0);
  EXPECT_TRUE(testing::identical(particles_, before));
}

}  // namespace
}  // namespace talus
