// Rigid bodies in sand: what they do to it, and it to them (method.md, section 10). The figures are in README.md.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <fstream>

#include "continuum/io/budget.h"
#include "tests/continuum/scenes.h"
#include "tests/continuum/solids/mesh_files.h"
#include "tests/test_folder.h"

namespace talus {
namespace {

using Eigen::Vector3d;
using testing::gravity;

constexpr double h = 0.01;  // m
constexpr double mu = 0.5;

/// A box of sand of so many cells in rough walls, `air` cells of space above it.
State bed(const Eigen::Vector3i& cells, int air) {
  const Eigen::Vector3i domain = cells + Eigen::Vector3i(0, 0, air);
  Scene scene = testing::box_scene(domain, cells.cast<double>(), h, mu);
  scene.jitter = 0.5;
  scene.sides[0] = scene.sides[1] = {Side{true, mu}, Side{true, mu}};
  scene.sides[2][0] = {true, mu};
  return initial_state(scene);
}

Body ball(const Vector3d& centre, double radius, double density, const Twist& twist = {}) {
  Body body = make_body("ball", Shape{Sphere{centre, radius}}, density, Free{}, twist);
  body.friction = mu;
  return body;
}

Vector3d momentum(const State& state) {
  Vector3d sum = state.particles.velocities * state.particles.masses.matrix();
  for (const Body& body : state.bodies) sum += body.mass * body.twist.velocity;
  return sum;
}

Vector3d angular_momentum(const State& state) {
  Vector3d sum = Vector3d::Zero();
  for (Eigen::Index p = 0; p < state.particles.count(); ++p) {
    const Vector3d position = state.particles.positions.col(p), velocity = state.particles.velocities.col(p);
    sum += state.particles.masses[p] * position.cross(velocity);
  }
  for (const Body& body : state.bodies) {
    const Eigen::Matrix3d turn = body.pose.orientation.toRotationMatrix();
    sum += body.mass * body.pose.position.cross(body.twist.velocity) +
           turn * body.inertia * turn.transpose() * body.twist.angular_velocity;
  }
  return sum;
}

// Measured: linear 1e-8 while no face is nearly empty, 3.5e-4 later, when splashed sand is on faces below
// smallest_face_fill, whose mass is bounded; angular 7e-4, of which FLIP's transfer has its part.
TEST(Bodies, AndSandKeepTheirMomentumWhenTheyCollide) {
  Scene scene = testing::box_scene({24, 24, 24}, {1, 1, 1}, h, mu);
  scene.fillings = {testing::box_of(0, h * Vector3d(6, 6, 4), h * Vector3d(18, 18, 12))};
  scene.gravity.setZero();
  State state = initial_state(scene);
  const double radius = 2.6 * h;
  add_bodies(state,
             {ball({0.121, 0.118, 0.12 + radius}, radius, 1500.0, {{0.1, 0.0, -0.5}, {0.0, 20.0, 5.0}})});
  const Vector3d linear = momentum(state), angular = angular_momentum(state);
  const double speed = state.bodies[0].twist.velocity.norm();
  double early = 0.0;
  testing::run_for(state, testing::step_settings(), 0.1, [&](const State& now, const StepReport& report) {
    EXPECT_EQ(report.cap_hits(), 0);
    if (now.time < 0.04) early = std::max(early, (momentum(now) - linear).norm() / linear.norm());
  });
  const double late = (momentum(state) - linear).norm() / linear.norm();
  const double turn = (angular_momentum(state) - angular).norm() / angular.norm();
  fmt::print("momentum changed by {:.1e} in 0.04 s, {:.1e} in 0.1 s; angular by {:.1e}\n", early, late, turn);
  EXPECT_LT(state.bodies[0].twist.velocity.norm(), 0.7 * speed);  // they did collide
  EXPECT_LT(early, 1e-6);
  EXPECT_LT(late, 2e-3);
  EXPECT_LT(turn, 3e-3);
}

TEST(Bodies, HeavyOneSinksRestsAndDoesNotCreep) {
  State state = bed({16, 16, 10}, 14);
  const double radius = 3.0 * h, surface = 10.0 * h;
  add_bodies(state, {ball({8.0 * h, 8.0 * h, surface + radius}, radius, 2500.0)});
  const double weight = state.bodies[0].mass * gravity, energy = total_energy(state);
  const StepSettings settings = testing::step_settings();
  double highest = energy;
  const auto watch = [&](const State& now, const StepReport&) {
    highest = std::max(highest, total_energy(now));
  };
  testing::run_for(state, settings, 0.3, watch);
  const double sunk = state.bodies[0].pose.position[2];
  double push = 0.0, time = 0.0;
  testing::run_for(state, settings, 0.5, [&](const State& now, const StepReport& report) {
    watch(now, report);
    push += report.on_bodies[0].linear[2];
    time += report.dt;
  });
  const double creep = (sunk - state.bodies[0].pose.position[2]) / radius;
  fmt::print("sank by {:.3f} R; then by {:.1e} R in 0.5 s; carried {:.4f} of its weight\n",
             (surface + radius - sunk) / radius, creep, push / time / weight);
  EXPECT_LT(sunk, surface + 0.9 * radius);
  EXPECT_GT(sunk, surface - radius);
  EXPECT_LT(std::abs(creep), 5e-3);
  EXPECT_NEAR(push / time / weight, 1.0, 0.01);
  EXPECT_LT(highest, energy * 1.001);
}

/// Where a ball is after the bed it lies in was shaken: gravity is 2.5 g for 0.03 s, and for another 0.03 s 0.5 g upwards and,
/// by turns, to either side.
double height_after_shaking(double density, int shakes) {
  State state = bed({14, 14, 12}, 14);
  add_bodies(state, {ball({7.0 * h, 7.0 * h, 7.5 * h}, 2.5 * h, density)});
  const StepSettings settings = testing::step_settings();
  for (int shake = 0; shake < shakes; ++shake) {
    state.gravity = {0.0, 0.0, -2.5 * gravity};
    testing::run_for(state, settings, 0.03, [](const State&, const StepReport&) {});
    state.gravity = gravity * Vector3d(shake % 2 ? 0.5 : -0.5, 0.0, 0.5);
    testing::run_for(state, settings, 0.03, [](const State&, const StepReport&) {});
  }
  return state.bodies[0].pose.position[2];
}

TEST(Bodies, LightOneFloatsOutWhenShakenAndHeavyOneSinks) {
  const double light = height_after_shaking(200.0, 60), heavy = height_after_shaking(4000.0, 36);
  fmt::print("from 7.5 h in a bed of 12 h, shaken: light ball at {:.2f} h, heavy one at {:.2f} h\n",
             light / h, heavy / h);
  EXPECT_GT(light, (12.0 - 0.5 * 2.5) * h);  // its top was 2 h below the surface, and is 1.5 R above
  EXPECT_LT(heavy, 7.0 * h);
}

/// The speed of a ball let go on a slope of sand, and that of its surface against its centre.
struct Rolling {
  double speed, surface;
};
Rolling roll(double friction) {
  constexpr double slope = 15.0 * std::numbers::pi / 180.0;
  Scene scene = testing::box_scene({40, 12, 14}, {40, 12, 5}, h, 0.6);
  scene.gravity = gravity * Vector3d(std::sin(slope), 0.0, -std::cos(slope));
  scene.jitter = 0.5;
  scene.grid.periodic[1] = true;
  scene.sides[0] = {Side{true, 0.6}, Side{true, 0.6}};
  scene.sides[2][0] = {true, 0.6};
  State state = initial_state(scene);
  const double radius = 3.0 * h;
  Body body = ball({0.08, 0.06, 5.0 * h + radius}, radius, 200.0);
  body.friction = friction;
  add_bodies(state, {body});
  testing::run_for(state, testing::step_settings(), 0.3, [](const State&, const StepReport&) {});
  return {state.bodies[0].twist.velocity[0], radius * state.bodies[0].twist.angular_velocity[1]};
}

TEST(Bodies, BallRollsDownASlopeOfSandWithoutSlippingWhenFrictionAllows) {
  const Rolling rough = roll(0.6), smooth = roll(0.0);
  fmt::print("v, omega R: {:.3f}, {:.3f} m/s rough; {:.3f}, {:.3f} m/s smooth\n", rough.speed, rough.surface,
             smooth.speed, smooth.surface);
  EXPECT_GT(rough.speed, 0.2);
  // It lies in the sand by a tenth of R: where it touches, it is nearer to the axis than R.
  EXPECT_NEAR(rough.surface / rough.speed, 1.0, 0.12);
  EXPECT_LT(smooth.surface / smooth.speed, 0.3);
}

/// Mean force on a plate of `deep` cells that is dragged along x through a bed, half cells wide on either side, N.
double drag(int deep) {
  State state = bed({30, 8, 12}, 3);
  const double speed = 0.15, surface = 12.0 * h;
  const Vector3d half(1.0 * h, 2.0 * h, 0.5 * (deep + 2) * h);
  const Vector3d centre(7.0 * h, 4.0 * h, surface - deep * h + half[2]);
  Body plate = make_body("plate", Shape{Box{centre, half}}, 2500.0,
                         Prescribed{{{speed, 0.0, 0.0}, Vector3d::Zero()}, 0.0, 10.0});
  plate.friction = mu;
  add_bodies(state, {plate});
  const StepSettings settings = testing::step_settings();
  testing::run_for(state, settings, 0.2, [](const State&, const StepReport&) {});
  double impulse = 0.0, time = 0.0;
  testing::run_for(state, settings, 0.2, [&](const State&, const StepReport& report) {
    impulse -= report.on_bodies[0].linear[0];
    time += report.dt;
  });
  return impulse / time;
}

TEST(Bodies, DragOnAPlateGrowsWithItsDepthSquared) {
  const double shallow = drag(3), deep = drag(6);
  const double exponent = std::log2(deep / shallow);
  fmt::print("drag {:.3f} N at 3 h, {:.3f} N at 6 h: grows with depth to the {:.2f}\n", shallow, deep,
             exponent);
  EXPECT_GT(shallow, 0.0);
  EXPECT_NEAR(exponent, 2.0, 0.35);
}

/// A lid a fifth of a cell thick, held up, with sand on it and none below.
void expect_lid_holds_sand(const Shape& shape) {
  Scene scene = testing::box_scene({12, 12, 16}, {1, 1, 1}, h, mu);
  scene.fillings = {testing::box_of(0, h * Vector3d(0, 0, 9), h * Vector3d(12, 12, 13))};
  scene.sides[0] = scene.sides[1] = {Side{true, 0.0}, Side{true, 0.0}};
  State state = initial_state(scene);
  const double mass = state.particles.masses.sum();
  Body lid = make_body("lid", shape, 1000.0, Prescribed{{}, 0.0, 10.0});
  lid.friction = mu;
  add_bodies(state, {lid});
  double push = 0.0, time = 0.0;
  testing::run_for(state, testing::step_settings(), 0.4, [&](const State& now, const StepReport& report) {
    if (now.time < 0.2) return;
    push -= report.on_bodies[0].linear[2];
    time += report.dt;
  });
  EXPECT_GT(state.particles.positions.row(2).minCoeff(), 8.0 * h);
  EXPECT_NEAR(push / time, mass * gravity, 0.01 * mass * gravity);
}

TEST(Bodies, ThinPlateHoldsSand) {
  expect_lid_holds_sand({Box{h * Vector3d(6, 6, 8.3), h * Vector3d(6, 6, 0.1)}});
}

TEST(Bodies, ThinPlateOfAMeshHoldsSandBesideAThickPart) {
  const testing::TestFolder folder;
  testing::Triangles triangles = testing::box_mesh(h * Vector3d(0, 0, 8.2), h * Vector3d(12, 12, 8.4));
  const testing::Triangles block = testing::box_mesh(h * Vector3d(3, 3, 2), h * Vector3d(9, 9, 6));
  triangles.insert(triangles.end(), block.begin(), block.end());
  testing::write_text_stl(folder.path() / "lid.stl", triangles);
  expect_lid_holds_sand({read_mesh(folder.path() / "lid.stl")});
}

/// Sand dropped into a cup that stands askew, its wall so many cells thick: none comes through.
void expect_cup_holds_sand(double wall) {
  const testing::TestFolder folder;
  std::ofstream(folder.path() / "cup.toml") << fmt::format(
      R"(schema = 1
[domain]
origin_m = [0.0, 0.0, 0.0]
size_m = [0.26, 0.26, 0.26]
cell_size_m = 0.01
gravity_m_s2 = [0.0, 0.0, -9.81]
[[material]]
name = "sand"
grain_density_kg_m3 = 2500.0
max_volume_fraction = 0.6
friction_angle_deg = 31.0
[[sand]]
material = "sand"
shape = {{ kind = "sphere", centre_m = [0.126, 0.128, 0.14], radius_m = 0.045 }}
[[body]]
name = "cup"
shape = {{ kind = "profile", base_m = [0.11, 0.12, 0.08], axis = [0.3, 0.2, 1], points_m = [[0, 0], [0.06, 0], [0.06, 0.12], [{0}, 0.12], [{0}, {1}], [0, {1}]] }}
density_kg_m3 = 1000.0
friction_angle_deg = 25.0
motion = {{ kind = "prescribed" }}
[particles]
per_cell_axis = 2
jitter = 0.5
seed = 1
[time]
end_s = 0.6
frame_interval_s = 0.05
)",
      0.06 - wall * h, wall * h);
  const Scene scene = read_scene(folder.path() / "cup.toml");
  State state = initial_state(scene);
  double deepest = 0.0, lost = 0.0;
  testing::run_for(state, testing::step_settings(), scene.end_time,
                   [&](const State&, const StepReport& report) {
                     deepest = std::max(deepest, report.collisions.deepest);
                     lost += report.mass_left;
                   });
  EXPECT_EQ(lost, 0.0);
  EXPECT_LT(deepest, h);
  const Vector3d axis = Vector3d(0.3, 0.2, 1.0).normalized();
  for (Eigen::Index p = 0; p < state.particles.count(); ++p) {
    const Vector3d from_base = state.particles.positions.col(p) - Vector3d(0.11, 0.12, 0.08);
    const double along = from_base.dot(axis), across = (from_base - along * axis).norm();
    ASSERT_GT(along, 0.0);
    ASSERT_TRUE(across < 0.06 || along > 0.12) << along << ' ' << across;
  }
}

TEST(Bodies, ThinCupsThatStandAskewHoldSand) {
  for (const double wall : {0.3, 0.6}) expect_cup_holds_sand(wall);
}

TEST(Bodies, WheelTurnsByTheTorquesOfSandAndHinge) {
  State state = bed({22, 10, 8}, 16);
  // A paddle that stands half in the bed; its hinge pulls at it.
  const Hinge hinge{h * Vector3d(11, 5, 12), Vector3d::UnitY(), 0.6};
  Body paddle =
      make_body("paddle", Shape{Box{h * Vector3d(11, 5, 9), h * Vector3d(0.7, 4, 5)}}, 1000.0, hinge);
  paddle.friction = mu;
  add_bodies(state, {paddle});
  const Body before = state.bodies[0];
  const double inertia = before.inertia(1, 1) + before.mass * 9.0 * h * h;  // about the hinge
  double by_sand = 0.0, by_weight = 0.0;
  Vector3d arm = before.pose.position - hinge.pivot;  // where forces act in a step
  testing::run_for(state, testing::step_settings(), 0.06, [&](const State& now, const StepReport& report) {
    by_sand += report.on_bodies[0].angular[1] + arm.cross(report.on_bodies[0].linear)[1];
    by_weight += report.dt * arm.cross(Vector3d(0.0, 0.0, -gravity * before.mass))[1];
    arm = now.bodies[0].pose.position - hinge.pivot;
  });
  const double gained = inertia * state.bodies[0].twist.angular_velocity[1];
  const double given = by_sand + by_weight + 0.06 * hinge.torque;
  fmt::print("angular momentum {:.4e} N m s; torques gave {:.4e}, of it the sand {:.4e}\n", gained, given,
             by_sand);
  EXPECT_NEAR((state.bodies[0].pose.position - hinge.pivot).norm(), 3.0 * h, 1e-12);
  EXPECT_LT(by_sand, -0.2 * 0.06 * hinge.torque);  // it resists
  EXPECT_GT(gained, 0.02 * 0.06 * hinge.torque);   // and turns: what is compared is no rounding
  EXPECT_NEAR(given / gained, 1.0, 0.05);
}

}  // namespace
}  // namespace talus
