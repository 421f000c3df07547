// Bodies over periodic seams: whatever they do, they do as in the middle of the domain.
#include "continuum/solids/body_images.h"

#include <gtest/gtest.h>

#include <array>

#include "continuum/numerical_faults.h"
#include "continuum/particles/move.h"
#include "continuum/render/bodies.h"
#include "continuum/solids/body_contacts.h"
#include "continuum/solids/body_step.h"
#include "continuum/solids/explosion.h"
#include "tests/continuum/scenes.h"

namespace talus {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Eigen::Vector3i;

// 1.6 x 0.8 x 1 m, periodic along x and y.
const Grid grid{{-0.3, 0, 0}, 0.1, {16, 8, 10}, {true, true, false}};
const DomainSides open_sides{};
const BodySurroundings surroundings{grid, open_sides, {}, {0, 0, -9.81}};

TEST(BodyImages, NearestOnes) {
  EXPECT_LT((nearest_image(grid, {1.25, 0.1, 0.9}, {-0.2, 0.7, 0.1}) - Vector3d(-0.35, 0.9, 0.9)).norm(),
            1e-12);
  EXPECT_LT((nearest_image(grid, {0.0, 0.1, 0.9}, {16.0, 0.1, 0.1}) - Vector3d(16.0, 0.1, 0.9)).norm(),
            1e-12);
  EXPECT_EQ(nearest_image(grid, {0.1, 0.1, 5.0}, {0.3, 0.2, 0.1}), Vector3d(0.1, 0.1, 5.0));
}

TEST(BodyImages, MovesThatMakeBoxesMeet) {
  const AlignedBox3d place(Vector3d(0, 0, 0), Vector3d(0.2, 0.2, 0.2));
  EXPECT_EQ(meeting_shifts(grid, {Vector3d(0.1, 0.1, 0.1), Vector3d(0.3, 0.3, 0.3)}, place),
            std::vector{Vector3d(0, 0, 0)});
  const auto over = meeting_shifts(grid, {Vector3d(1.5, 0.1, 0.1), Vector3d(1.7, 0.3, 0.3)}, place);
  ASSERT_EQ(over.size(), 1U);
  EXPECT_LT((over[0] - Vector3d(-1.6, 0, 0)).norm(), 1e-12);
  EXPECT_TRUE(meeting_shifts(grid, {Vector3d(0.3, 0.1, 0.1), Vector3d(0.5, 0.3, 0.3)}, place).empty());
  EXPECT_TRUE(meeting_shifts(grid, {Vector3d(0.1, 0.1, 0.3), Vector3d(0.3, 0.3, 0.5)}, place).empty());
  EXPECT_EQ(meeting_shifts(grid, {Vector3d(-0.3, -0.1, 0.1), Vector3d(1.4, 0.9, 0.3)}, place).size(), 2U);
  EXPECT_EQ(shifts_into_domain(grid, {Vector3d(1.2, 0.7, 5.0), Vector3d(1.4, 0.9, 5.1)}).size(), 4U);
}

TEST(BodyImages, PlacesOutOfAllBoundsAreRefused) {
  EXPECT_THROW(shifts_into_domain(grid, {Vector3d(1e18, 0, 0), Vector3d(1e18, 1, 1)}), NumericalError);
  EXPECT_THROW(shifts_into_domain(grid, {Vector3d(-1e7, 0, 0), Vector3d(1e7, 1, 1)}), NumericalError);
  EXPECT_EQ(shifts_into_domain(grid, {Vector3d(1e7, 0.1, 0), Vector3d(1e7 + 0.1, 0.2, 1)}).size(), 1U);
}

/// A body like no mirror image of itself.
Body peg(const Vector3d& at) {
  return make_body("peg", {Capsule{at, at + Vector3d(0.2, 0.15, 0.1), 0.13}}, 2000.0);
}

TEST(BodyImages, GridSeesTheSameOfABodyWhereverItsSeamsAre) {
  const std::array in_the_middle{peg({0.31, 0.33, 0.42})};
  Openings expected;
  find_openings(grid, {}, in_the_middle, swellings(in_the_middle, grid.spacing), expected);
  for (const Vector3i& moved :
       {Vector3i(8, 0, 0), Vector3i(-5, 4, 0), Vector3i(-6, -3, 0), Vector3i(25, 36, 0)}) {
    const std::array bodies{peg(Vector3d(0.31, 0.33, 0.42) + 0.1 * moved.cast<double>())};
    Openings openings;
    find_openings(grid, {}, bodies, swellings(bodies, grid.spacing), openings);
    for (int cell = 0; cell < grid.cells.prod(); ++cell) {
      const Vector3i at = grid.cell_of_index(cell);
      const int there = grid.cell_index(at + moved);
      EXPECT_NEAR(openings.cells[there], expected.cells[cell], 1e-12);
      EXPECT_NEAR(openings.cell_kernel[there], expected.cell_kernel[cell], 1e-12);
      EXPECT_EQ(openings.body[there], expected.body[cell]);
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(openings.face_share(axis, grid.face_index(axis, at + moved)),
                    expected.face_share(axis, grid.face_index(axis, at)), 1e-12);
    }
  }
  EXPECT_LT(expected.cells.minCoeff(), 0.1);
}

TEST(BodyImages, SandIsKeptOutOfAllOfABody) {
  const std::array bodies{peg({1.2, 0.7, 0.4})};
  const std::vector swollen{0.0};
  EXPECT_TRUE(in_a_body(grid, bodies, swollen, {1.25, 0.75, 0.4}));
  EXPECT_TRUE(in_a_body(grid, bodies, swollen, {-0.25, 0.75, 0.45}));  // over x's seam
  EXPECT_TRUE(in_a_body(grid, bodies, swollen, {-0.25, 0.02, 0.5}));   // over both
  EXPECT_FALSE(in_a_body(grid, bodies, swollen, {-0.25, 0.4, 0.5}));
}

std::vector<Twist> after_contact(std::vector<Body> bodies, const BodySurroundings& around = surroundings) {
  for (Body& body : bodies) body.contact_friction = 0.5;
  std::vector<Twist> twists = twists_of(bodies);
  resolve_contacts(bodies, around, 0.0, 1e-3, twists);
  return twists;
}

void expect_same(const std::vector<Twist>& a, const std::vector<Twist>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_LT((a[i].velocity - b[i].velocity).norm(), 1e-9) << i;
    EXPECT_LT((a[i].angular_velocity - b[i].angular_velocity).norm(), 1e-9) << i;
  }
}

Body block(double x, const Twist& twist, const BodyMotion& motion = Free{}) {
  return make_body("block", {Box{{x, 0.4, 0.4}, {0.1, 0.08, 0.12}}}, 2000.0, motion, twist);
}

TEST(BodyImages, BodiesCollideOverASeam) {
  const auto train = [](double x, const BodyMotion& last) {  // two that touch a third, off the line
    return std::vector<Body>{block(x, {{1.0, 0.2, 0.0}}), block(x + 0.397, {}, last),
                             make_body("ball", {Sphere{{x + 0.198, 0.37, 0.42}, 0.1}}, 3000.0)};
  };
  for (const BodyMotion& last : {BodyMotion{Free{}}, BodyMotion{Prescribed{{{-0.5, 0, 0}, {0, 0, 3}}}}}) {
    const std::vector<Twist> expected = after_contact(train(0.2, last));
    EXPECT_GT((expected[0].velocity - Vector3d(1.0, 0.2, 0.0)).norm(), 0.1);
    for (const std::array<int, 3>& turns :
         {std::array{0, 0, 0}, {0, -1, -1}, {1, 0, 0}, {0, -1, 0}, {-1, 3, 7}}) {
      std::vector<Body> bodies = train(0.2, last);
      for (std::size_t b = 0; b < bodies.size(); ++b) bodies[b].pose.position[0] += 1.6 * turns[b];
      expect_same(after_contact(bodies), expected);
    }
  }
}

TEST(BodyImages, SandAndABodyPushEachOtherAsInTheMiddle) {
  Scene scene = testing::box_scene({14, 12, 14}, {14, 12, 6}, 0.01, 0.5);
  scene.grid.periodic = {true, true, false};
  scene.sides[2][0] = {true, 0.5};
  scene.gravity = {2.0, 1.0, -9.0};
  scene.jitter = 0.5;
  Body ball =
      make_body("ball", {Sphere{{0.07, 0.06, 0.065}, 0.022}}, 3000.0, Free{}, {{0.3, 0.2, -0.5}, {3, -5, 8}});
  ball.friction = 0.5;
  scene.bodies = {ball};
  State middle = initial_state(scene);
  scene.bodies.clear();
  State seam = initial_state(scene);
  const Vector3d moved = 0.01 * Vector3d(7, -19, 0);
  seam.particles = middle.particles;
  seam.particles.positions.colwise() += moved;
  wrap_positions(seam.grid, seam.particles.positions);
  add_bodies(seam, {shifted(ball, moved)});
  for (int i = 0; i < 8; ++i) {
    step(middle, {}, 0.002);
    step(seam, {}, 0.002);
  }
  const Body &expected = middle.bodies[0], &found = seam.bodies[0];
  EXPECT_GT((expected.twist.angular_velocity - ball.twist.angular_velocity).norm(), 1.0);
  const double solved = 0.01 * scene.gravity.norm() * 0.002;  // what friction is solved to, m/s
  EXPECT_LT((found.twist.velocity - expected.twist.velocity).norm(), solved);
  EXPECT_LT((found.twist.angular_velocity - expected.twist.angular_velocity).norm(), solved / 0.022);
  EXPECT_LT((found.pose.position - moved - expected.pose.position).norm(), 8 * 0.002 * solved);
}

TEST(BodyImages, BodiesThatMoveAreStoppedByEachOtherOverASeam) {
  std::array bodies{block(-0.1, {{-20.0, 0.0, 0.0}}), block(1.1, {})};
  for (Body& body : bodies) body.contact_friction = 0.0;
  move_with_contacts(bodies, surroundings, 0.0, 0.01);  // 0.2 m, of which 0.2 m are free
  move_with_contacts(bodies, surroundings, 0.01, 0.01);
  EXPECT_NEAR(bodies[0].twist.velocity[0], -10.0, 1e-6);
  EXPECT_NEAR(bodies[1].twist.velocity[0], -10.0, 1e-6);
}

TEST(BodyImages, WallsCarryWhatLiesOverASeam) {
  const auto on_floor = [](double x, double floor_from) {
    Wall floor{};
    floor.shape.geometry = Box{{floor_from + 0.3, 0.4, 0.1}, {0.3, 0.4, 0.1}};
    const std::array walls{floor};
    Body ball = make_body("ball", {Sphere{{x, 0.4, 0.2999}, 0.1}}, 2000.0);
    ball.twist.velocity = {0.5, 0.0, -1.0};
    return after_contact({ball}, {grid, open_sides, walls, {0, 0, -9.81}});
  };
  const std::vector<Twist> expected = on_floor(0.4, 0.1);
  EXPECT_NEAR(expected[0].velocity[2], 0.0, 1e-9);
  EXPECT_GT(expected[0].angular_velocity[1], 1.0);
  expect_same(on_floor(0.4 + 3.2, 0.1), expected);
  expect_same(on_floor(1.35, -0.3), expected);  // the floor stands on the other side
}

TEST(BodyImages, RingAllTheWayAroundIsRefused) {
  std::vector<Body> ring;
  for (int i = 0; i < 8; ++i) ring.push_back(block(-0.2 + 0.1999 * i, {{0.1 * i, 0, 0}}));
  EXPECT_NO_THROW(after_contact(ring));  // it does not close yet
  for (int i = 0; i < 8; ++i) ring[static_cast<std::size_t>(i)].pose.position[0] = -0.2 + 0.2 * i;
  for (Body& body : ring) body.shape.geometry = Box{{0, 0, 0}, {0.1001, 0.08, 0.12}};
  EXPECT_THROW(after_contact(ring), NumericalError);
}

TEST(BodyImages, OnlyWhatIsNearTheDomainIsWaitedFor) {
  const std::array bodies{peg({0.3, 0.3, -1.0})};
  const std::array falling{Twist{{0, 0, -10}}};
  EXPECT_EQ(fastest_surface(grid, bodies, falling, 1e-3), 0.0);
  EXPECT_EQ(fastest_surface(grid, bodies, falling, 0.1), 10.0);  // it could come back as fast
  EXPECT_EQ(fastest_surface(grid, std::array{peg({0.3, 0.3, -0.2})}, falling, 1e-3), 10.0);
  EXPECT_EQ(fastest_surface(grid, std::array{peg({160.3, 0.3, 0.5})}, falling, 1e-3), 10.0);
}

TEST(BodyImages, ExplosionsReachOverASeam) {
  const Explosion blast{0.5, {1.25, 0.4, 0.5}, 0.3, 3.0};
  std::array bodies{make_body("ball", {Sphere{{-0.25 + 16.0, 0.4, 0.5}, 0.05}}, 1000.0)};
  Particles particles;
  particles.resize(1);
  particles.positions.col(0) = Vector3d(-0.25, 0.4, 0.5);
  particles.velocities.setZero();
  apply_explosion(grid, blast, particles, bodies);
  EXPECT_LT((particles.velocities.col(0) - Vector3d(3, 0, 0)).norm(), 1e-12);
  EXPECT_LT((bodies[0].twist.velocity - Vector3d(3, 0, 0)).norm(), 1e-12);
}

TEST(BodyImages, PicturesShowAllThatTheDomainSees) {
  DrawnBody body{"tile", {{{-0.1F, 0, 0}, {0.1F, 0, 0}, {0, 0.1F, 0}}, {{0, 1, 2}}}, {}};
  const auto drawn = [&](const Vector3d& at) {
    body.moments = {{0.0, Eigen::Isometry3d(Eigen::Translation3d(at))}};
    return images_at(body, 0.0, grid);
  };
  EXPECT_EQ(drawn({0.5, 0.3, 0.5}).size(), 1U);
  ASSERT_EQ(drawn({1.25 + 1.6, 0.3, 0.5}).size(), 2U);
  EXPECT_LT((drawn({1.25 + 1.6, 0.3, 0.5})[0].translation() - Vector3d(-0.35, 0.3, 0.5)).norm(), 1e-12);
  EXPECT_LT((drawn({1.25 + 1.6, 0.3, 0.5})[1].translation() - Vector3d(1.25, 0.3, 0.5)).norm(), 1e-12);
}

}  // namespace
}  // namespace talus
