// Bodies that touch: what Newton, Coulomb and Euler say must come out of the library.
#include "continuum/solids/body_contacts.h"

#include <gtest/gtest.h>

#include <numbers>

#include "continuum/solids/surface_mesh.h"
#include "tests/continuum/solids/mesh_files.h"
#include "tests/test_folder.h"

namespace talus {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double g = 9.81, dt = 2e-3;
const Grid grid{{-2, -2, 0}, 0.1, {40, 40, 40}, {false, false, false}};
const DomainSides open_sides{};
const DomainSides floor_only = [] {
  DomainSides sides;
  sides[2][0].wall = true;
  return sides;
}();
const Vector3d down(0, 0, -g);

Mesh cube_mesh(double half) {
  const testing::TestFolder folder;
  testing::write_text_stl(folder.path() / "cube.stl",
                          testing::box_mesh(Vector3d::Constant(-half), Vector3d::Constant(half)));
  return read_mesh(folder.path() / "cube.stl");
}

Body body_of(const Shape& shape, double friction = 0.5, double restitution = 0.0,
             const BodyMotion& motion = Free{}) {
  Body body = make_body("body", shape, 2000.0, motion);
  body.contact_friction = friction;
  body.restitution = restitution;
  return body;
}

void fall(std::span<Body> bodies, const BodySurroundings& surroundings, double duration) {
  for (double time = 0.0; time < duration - 0.5 * dt; time += dt) {
    for (Body& body : bodies) {
      Eigen::Matrix<double, 6, 1> impulse = Eigen::Matrix<double, 6, 1>::Zero();
      impulse.head<3>() = dt * body.mass * surroundings.gravity;
      const Eigen::Matrix<double, 6, 1> change = inverse_mass(body) * impulse;
      body.twist.velocity += change.head<3>();
      body.twist.angular_velocity += change.tail<3>();
    }
    move_with_contacts(bodies, surroundings, time, dt);
  }
}

struct Sums {
  Vector3d momentum = Vector3d::Zero(), angular = Vector3d::Zero();  // about the origin
  double energy = 0.0;
};

Sums sums_of(std::span<const Body> bodies, std::span<const Twist> twists) {
  Sums sums;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Matrix3d rotation = bodies[i].pose.orientation.toRotationMatrix();
    const Vector3d p = bodies[i].mass * twists[i].velocity;
    const Vector3d spin = rotation * bodies[i].inertia * rotation.transpose() * twists[i].angular_velocity;
    sums.momentum += p;
    sums.angular += bodies[i].pose.position.cross(p) + spin;
    sums.energy += 0.5 * (p.dot(twists[i].velocity) + spin.dot(twists[i].angular_velocity));
  }
  return sums;
}

struct NamedShape {
  std::string name;
  Shape shape;    // some 0.1 m in size, about the origin
  double lowest;  // z of its lowest point
};

std::vector<NamedShape> body_shapes() {
  return {{"Sphere", {Sphere{{0, 0, 0}, 0.1}}, -0.1},
          {"Box", {Box{{0, 0, 0}, {0.1, 0.08, 0.12}}}, -0.12},
          {"Capsule", {Capsule{{-0.06, 0, 0}, {0.06, 0, 0}, 0.08}}, -0.08},
          {"StandingCylinder", {cylinder({0, 0, -0.1}, Vector3d::UnitZ(), 0.1, 0.2)}, -0.1},
          {"LyingCylinder", {cylinder({0, -0.1, 0}, Vector3d::UnitY(), 0.1, 0.2)}, -0.1},
          {"Cone", {cone({0, 0, -0.05}, Vector3d::UnitZ(), 0.12, 0.03, 0.15)}, -0.05},
          {"Mesh", {cube_mesh(0.1)}, -0.1}};
}

class Pair : public ::testing::TestWithParam<std::tuple<std::size_t, std::size_t>> {
 public:
  static std::string name(const ::testing::TestParamInfo<ParamType>& info) {
    return body_shapes()[std::get<0>(info.param)].name + body_shapes()[std::get<1>(info.param)].name;
  }
};

TEST_P(Pair, KeepsItsMomentumAndLosesEnergy) {
  const Shape lower = body_shapes()[std::get<0>(GetParam())].shape,
              upper = body_shapes()[std::get<1>(GetParam())].shape;
  std::array bodies{body_of(lower, 0.4, 0.3), body_of(upper, 0.6, 0.8)};
  // Above each other, a little aside, and as near as they overlap by a bit.
  bodies[1].pose.position = {0.013, -0.021, 0.3};
  const auto touching = [&] {
    ContactFinder finder(bodies, {grid, open_sides, {}, Vector3d::Zero()});
    return !finder.find(bodies, 0.0).empty();
  };
  while (!touching() && bodies[1].pose.position[2] > 0.05) bodies[1].pose.position[2] -= 0.002;
  ASSERT_GT(bodies[1].pose.position[2], 0.05);
  std::array<Twist, 2> twists{Twist{{0, 0, 0.5}, {0.1, 2.0, 0.3}},
                              Twist{{0.3, -0.2, -1.5}, {-1.0, 0.2, 1.0}}};
  const Sums before = sums_of(bodies, twists);
  const Twist first = twists[0];
  resolve_contacts(bodies, {grid, open_sides, {}, Vector3d::Zero()}, 0.0, dt, twists);
  const Sums after = sums_of(bodies, twists);
  EXPECT_GT((twists[0].velocity - first.velocity).norm(), 0.3);
  const double scale = bodies[0].mass * 2.0;
  EXPECT_LT((after.momentum - before.momentum).norm(), 1e-13 * scale);
  EXPECT_LT((after.angular - before.angular).norm(), 1e-13 * scale);
  EXPECT_LT(after.energy, before.energy);
}

INSTANTIATE_TEST_SUITE_P(BodyContacts, Pair,
                         ::testing::Combine(::testing::Range<std::size_t>(0, 7),
                                            ::testing::Range<std::size_t>(0, 7)),
                         Pair::name);

class Resting : public ::testing::TestWithParam<std::size_t> {
 public:
  static std::string name(const ::testing::TestParamInfo<std::size_t>& info) {
    return body_shapes()[info.param].name;
  }
};

TEST_P(Resting, OnTheFloorItStays) {
  const NamedShape shape = body_shapes()[GetParam()];
  std::array bodies{body_of(shape.shape)};
  bodies[0].pose.position[2] += -shape.lowest;
  const Pose start = bodies[0].pose;
  fall(bodies, {grid, floor_only, {}, down}, 2.0);
  EXPECT_LT((bodies[0].pose.position - start.position).norm(), 4e-4);
  EXPECT_LT(bodies[0].pose.orientation.angularDistance(start.orientation), 2e-3);
  EXPECT_LT(bodies[0].twist.velocity.norm(), 1e-4);
}

TEST_P(Resting, DroppedItComesToRestOnTheFloor) {
  const NamedShape shape = body_shapes()[GetParam()];
  std::array bodies{body_of(shape.shape)};
  bodies[0].pose.position[2] += -shape.lowest + 0.2;
  fall(bodies, {grid, floor_only, {}, down}, 2.0);
  EXPECT_NEAR(bounds(bodies[0]).min()[2], 0.0, 1e-3);
  EXPECT_LT(std::abs(bodies[0].twist.velocity[2]), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(BodyContacts, Resting, ::testing::Range<std::size_t>(0, 7), Resting::name);

struct NamedWall {
  std::string name;
  Shape shape;
};

std::vector<NamedWall> walls_to_rest_on() {
  return {{"Plane", {Plane{{0, 0, 0.5}, Vector3d::UnitZ()}}},
          {"Box", {Box{{0, 0, 0.4}, {1, 1, 0.1}}}},
          {"Sphere", {Sphere{{0, 0, 0.2}, 0.3}}},
          {"Cylinder", {cylinder({0, 0, 0.1}, Vector3d::UnitZ(), 0.5, 0.4)}},
          {"Capsule", {Capsule{{-0.05, 0, 0.3}, {0.05, 0, 0.3}, 0.2}}},
          {"Frustum", {cone({0, 0, 0.1}, Vector3d::UnitZ(), 0.5, 0.3, 0.4)}},
          {"Mesh", {shifted(cube_mesh(0.25), {0.01, 0.02, 0.25})}},
          {"HollowBox", {Box{{0, 0, 1.0}, {0.5, 0.5, 0.5}}, true}},
          {"HollowSphere", {Sphere{{0, 0, 1.0}, 0.5}, true}},
          {"HollowHourglass", {hourglass({0, 0, 0.5}, Vector3d::UnitZ(), {0.4, 0.2, 0.05, 0.1, 0.8}), true}}};
}

class OnWalls : public ::testing::TestWithParam<std::size_t> {
 public:
  static std::string name(const ::testing::TestParamInfo<std::size_t>& info) {
    return walls_to_rest_on()[info.param].name;
  }
};

/// The least distance of the body's surface to the wall, m.
double deepest_of(const Body& body, const Shape& wall) {
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& triangle : surface_mesh(body.shape)) {
    for (const Vector3d& corner : triangle)
      least = std::min(least, signed_distance(wall, body.pose.position + body.pose.orientation * corner));
  }
  if (wall.hollow || std::holds_alternative<Plane>(wall.geometry)) return least;
  for (const Triangle& triangle : surface_mesh(wall)) {
    for (const Vector3d& corner : triangle) least = std::min(least, signed_distance(body, corner));
  }
  return least;
}

TEST_P(OnWalls, ASphereAndABoxComeToRest) {
  const std::array walls{Wall{walls_to_rest_on()[GetParam()].shape, 0.5}};
  for (const std::size_t which : {0U, 1U}) {
    std::array bodies{body_of(body_shapes()[which].shape)};
    bodies[0].pose.position = {0, 0, 0.65};
    fall(bodies, {grid, open_sides, walls, down}, 2.0);
    const double distance = deepest_of(bodies[0], walls[0].shape);
    EXPECT_NEAR(distance, 0.0, 2e-3) << which;
    EXPECT_LT(bodies[0].twist.velocity.norm(), 1e-2) << which;
  }
}

INSTANTIATE_TEST_SUITE_P(BodyContacts, OnWalls, ::testing::Range<std::size_t>(0, 10), OnWalls::name);

TEST(BodyContacts, AGateHoldsUntilItOpens) {
  const std::array walls{Wall{{Box{{0, 0, 1.0}, {1, 1, 0.1}}}, 0.5, 1.0}};
  std::array bodies{body_of({Sphere{{0, 0, 1.2}, 0.1}})};
  fall(bodies, {grid, open_sides, walls, down}, 1.0);
  EXPECT_NEAR(bodies[0].pose.position[2], 1.2, 1e-3);
  BodySurroundings opened{grid, open_sides, {}, down};
  EXPECT_EQ(move_with_contacts(bodies, {grid, open_sides, walls, down}, 1.0, dt), 1);
  fall(bodies, opened, 0.2);
  EXPECT_NEAR(bodies[0].pose.position[2], 1.2 - 0.5 * g * 0.04, 6e-3);
}

TEST(BodyContacts, ASphereRollsDownASlopeWithoutSlippingWhereFrictionAllows) {
  for (const double slope : {0.2, 0.5}) {
    std::array bodies{body_of({Sphere{{0, 0, 0.1}, 0.1}}, 0.3)};
    const Vector3d along(0.6, -0.8, 0.0),
        gravity = g * (std::sin(slope) * along - std::cos(slope) * Vector3d::UnitZ());
    const double duration = 0.4;
    fall(bodies, {grid, floor_only, {}, gravity}, duration);
    const bool rolls = std::tan(slope) < 3.5 * 0.3;
    ASSERT_TRUE(rolls);
    EXPECT_NEAR(bodies[0].twist.velocity.dot(along), 5.0 / 7.0 * g * std::sin(slope) * duration, 2e-3);
    EXPECT_LT(velocity_at(bodies[0], bodies[0].pose.position - Vector3d(0, 0, 0.1)).norm(), 2e-3);
  }
}

TEST(BodyContacts, ASphereSlipsDownASlopeThatIsTooSteep) {
  const double slope = 0.6, friction = 0.1, duration = 0.3;
  std::array bodies{body_of({Sphere{{0, 0, 0.1}, 0.1}}, friction)};
  const Vector3d along(0.6, -0.8, 0.0);
  fall(bodies, {grid, floor_only, {}, g * (std::sin(slope) * along - std::cos(slope) * Vector3d::UnitZ())},
       duration);
  const double acceleration = g * (std::sin(slope) - friction * std::cos(slope));
  EXPECT_NEAR(bodies[0].twist.velocity.dot(along), acceleration * duration, 0.005 * acceleration * duration);
  EXPECT_NEAR(bodies[0].twist.angular_velocity.norm(), 2.5 * friction * g * std::cos(slope) * duration / 0.1,
              0.1);
}

TEST(BodyContacts, ABoxOnASlopeHoldsOrSlidesAsCoulombSays) {
  const double slope = 0.4;
  const Vector3d along(0.6, -0.8, 0.0),
      gravity = g * (std::sin(slope) * along - std::cos(slope) * Vector3d::UnitZ());
  std::array bodies{body_of({Box{{0, 0, 0.05}, {0.2, 0.2, 0.05}}}, 1.05 * std::tan(slope))};
  fall(bodies, {grid, floor_only, {}, gravity}, 1.0);
  EXPECT_LT(bodies[0].pose.position.head<2>().norm(), 1e-3);
  bodies[0] = body_of({Box{{0, 0, 0.05}, {0.2, 0.2, 0.05}}}, 0.5 * std::tan(slope));
  fall(bodies, {grid, floor_only, {}, gravity}, 0.5);
  EXPECT_NEAR(bodies[0].twist.velocity.dot(along), 0.5 * g * std::sin(slope) * 0.5, 0.01);
}

TEST(BodyContacts, RestitutionIsThatOfTheSofter) {
  for (const double restitution : {0.0, 0.5, 0.9}) {
    std::array bodies{body_of({Sphere{{0, 0, 1.0}, 0.1}}, 0.0, restitution)};
    bodies[0].twist.velocity = {0, 0, -2.0};
    const BodySurroundings weightless{grid, floor_only, {}, Vector3d::Zero()};
    for (int i = 0; i < 500; ++i) move_with_contacts(bodies, weightless, i * dt, dt);
    EXPECT_NEAR(bodies[0].twist.velocity[2], 2.0 * restitution, 1e-9);
    std::array pair{body_of({Sphere{{0, 0, 1.0}, 0.1}}, 0.0, restitution),
                    body_of({Sphere{{0, 0, 1.199}, 0.1}}, 0.0, 1.0)};
    std::array<Twist, 2> twists{Twist{{0, 0, 1.0}}, Twist{{0, 0, -1.0}}};
    resolve_contacts(pair, weightless, 0.0, dt, twists);
    EXPECT_NEAR(twists[1].velocity[2], restitution, 1e-9);
  }
}

TEST(BodyContacts, ABouncingBallComesToRest) {
  std::array bodies{body_of({Sphere{{0, 0, 0.3}, 0.1}}, 0.5, 0.7)};
  fall(bodies, {grid, floor_only, {}, down}, 4.0);
  EXPECT_NEAR(bodies[0].pose.position[2], 0.1, 1e-3);
  EXPECT_LT(bodies[0].twist.velocity.norm(), 1e-6);
}

TEST(BodyContacts, AStackOfThreeStays) {
  std::vector<Body> bodies;
  for (int i = 0; i < 3; ++i) bodies.push_back(body_of({Box{{0.01 * i, 0, 0.1 + 0.2 * i}, {0.1, 0.1, 0.1}}}));
  const std::vector<Body> start = bodies;
  fall(bodies, {grid, floor_only, {}, down}, 3.0);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT((bodies[i].pose.position - start[i].pose.position).norm(), 1e-3) << i;
    EXPECT_LT(bodies[i].pose.orientation.angularDistance(start[i].pose.orientation), 2e-3) << i;
  }
}

TEST(BodyContacts, AMeshRestsOnAMesh) {
  std::array bodies{body_of({cube_mesh(0.1)}), body_of({cube_mesh(0.1)})};
  bodies[0].pose.position = {0, 0, 0.1};
  bodies[1].pose.position = {0.007, 0.004, 0.303};
  fall(bodies, {grid, floor_only, {}, down}, 0.4);
  EXPECT_LT((bodies[1].pose.position - Vector3d(0.007, 0.004, 0.3)).norm(), 3e-3);
  EXPECT_LT(bodies[1].pose.orientation.angularDistance(Eigen::Quaterniond::Identity()), 0.03);
}

TEST(BodyContacts, AHingedWheelTakesTheBallsAngularMomentum) {
  const Vector3d pivot(0, 0, 1);
  std::array bodies{body_of({Box{{0, 0, 1}, {0.3, 0.1, 0.02}}}, 0.0, 0.5, Hinge{pivot, Vector3d::UnitY()}),
                    body_of({Sphere{{0.25, 0, 1.119}, 0.1}}, 0.0, 0.5)};
  std::array<Twist, 2> twists{Twist{}, Twist{{0, 0, -2.0}}};
  const auto about_axis = [&] {
    const Vector3d arm = bodies[1].pose.position - pivot;
    return bodies[0].inertia(1, 1) * twists[0].angular_velocity[1] +
           bodies[1].mass * arm.cross(twists[1].velocity)[1];
  };
  const double before = about_axis();
  resolve_contacts(bodies, {grid, open_sides, {}, Vector3d::Zero()}, 0.0, dt, twists);
  EXPECT_NEAR(about_axis(), before, 1e-9 * std::abs(before));
  EXPECT_GT(twists[0].angular_velocity[1], 0.5);
  EXPECT_EQ(twists[0].velocity.norm(), 0.0);  // it turns about its own centre
  EXPECT_EQ(twists[0].angular_velocity[0], 0.0);
  const double parting = twists[1].velocity[2] + 0.25 * twists[0].angular_velocity[1];
  EXPECT_NEAR(parting, 0.5 * 2.0, 1e-6);
}

TEST(BodyContacts, AMoverPushesAndIsNotPushed) {
  const Prescribed motion{{{0.5, 0, 0}, {0, 0, 0}}};
  std::array bodies{body_of({Box{{-0.3, 0, 0.1}, {0.1, 0.1, 0.09}}}, 0.2, 0.0, motion),
                    body_of({Box{{0.0, 0, 0.1}, {0.1, 0.1, 0.1}}}, 0.2)};
  fall(bodies, {grid, floor_only, {}, down}, 1.0);
  EXPECT_NEAR(bodies[0].pose.position[0], 0.2, 1e-12);
  EXPECT_NEAR(bodies[1].pose.position[0], 0.4, 2e-3);
  EXPECT_NEAR(bodies[1].twist.velocity[0], 0.5, 1e-3);
}

TEST(BodyContacts, OverlapIsPartedWithoutVelocity) {
  std::array bodies{body_of({Sphere{{0, 0, 0.1}, 0.1}}), body_of({Sphere{{0.18, 0, 0.1}, 0.1}})};
  const BodySurroundings weightless{grid, open_sides, {}, Vector3d::Zero()};
  for (int i = 0; i < 100; ++i) move_with_contacts(bodies, weightless, i * dt, dt);
  const double distance = (bodies[1].pose.position - bodies[0].pose.position).norm();
  EXPECT_NEAR(distance, 0.2 - 1e-4, 1e-5);
  EXPECT_EQ(bodies[0].twist.velocity.norm() + bodies[1].twist.velocity.norm(), 0.0);
}

TEST(BodyContacts, WhatIsFastIsMovedInParts) {
  std::array bodies{body_of({Box{{0, 0, 0.3}, {0.2, 0.2, 0.002}}})};
  bodies[0].twist.velocity = {0, 0, -5.0};
  EXPECT_GT(move_with_contacts(bodies, {grid, floor_only, {}, Vector3d::Zero()}, 0.0, 0.1), 100);
  EXPECT_NEAR(bodies[0].pose.position[2], 0.002, 2e-4);  // and not 0.2 below the floor
  bodies[0].twist.velocity = {0, 0, 5.0};
  EXPECT_EQ(move_with_contacts(bodies, {grid, open_sides, {}, Vector3d::Zero()}, 0.0, 0.1),
            1);  // nothing to touch
}

TEST(BodyContacts, WhatTouchesNothingKeepsItsTwistAndResultsRepeat) {
  const auto shapes = body_shapes();
  std::vector<Body> bodies;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    bodies.push_back(body_of(shapes[i].shape, 0.5, 0.2));
    bodies.back().pose.position = {0.02 * static_cast<double>(i % 3), 0.01 * static_cast<double>(i % 2),
                                   0.12 + 0.21 * static_cast<double>(i)};
  }
  bodies.push_back(body_of({Sphere{{1.5, 0, 1.0}, 0.1}}));
  bodies.back().twist = {{0.1, 0.2, 0.3}, {1, 2, 3}};
  const BodySurroundings surroundings{grid, floor_only, {}, down};
  std::vector<Body> again = bodies;
  std::vector<Twist> twists(bodies.size());
  twists.back() = bodies.back().twist;
  resolve_contacts(bodies, surroundings, 0.0, dt, twists);
  EXPECT_EQ(twists.back().velocity, bodies.back().twist.velocity);
  EXPECT_EQ(twists.back().angular_velocity, bodies.back().twist.angular_velocity);
  fall(bodies, surroundings, 0.6);
  fall(again, surroundings, 0.6);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    EXPECT_EQ(bodies[i].pose.position, again[i].pose.position) << i;
    EXPECT_EQ(bodies[i].pose.orientation.coeffs(), again[i].pose.orientation.coeffs()) << i;
  }
}

}  // namespace
}  // namespace talus
