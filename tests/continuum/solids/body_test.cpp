// What rigid bodies are and how they move without forces.
#include "continuum/solids/body.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "continuum/solids/mass_properties.h"
#include "tests/continuum/solids/specimens.h"

namespace talus {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double pi = std::numbers::pi;
const Box brick{{1.0, 2.0, 3.0}, {0.5, 0.3, 0.1}};
const Vector3d oblique = Vector3d(2.0, -1.0, 2.0) / 3.0;

Vector3d angular_momentum(const Body& body) {
  const Matrix3d rotation = body.pose.orientation.toRotationMatrix();
  return rotation * body.inertia * rotation.transpose() * body.twist.angular_velocity;
}
double turning_energy(const Body& body) {
  return 0.5 * angular_momentum(body).dot(body.twist.angular_velocity);
}

class EveryBody : public ::testing::TestWithParam<testing::SpecimenMaker> {};

TEST_P(EveryBody, TakesItsSurfaceAlong) {
  const testing::Specimen specimen = GetParam().make();
  if (body_fault(specimen.shape)) return;
  Body body = make_body("specimen", specimen.shape, 1000.0);
  const bool sampled = std::holds_alternative<SampledMesh>(body.shape.geometry);
  const double tolerance = sampled ? 0.03 : 1e-12;  // a spacing is 0.06, and there are edges
  const Vector3d centre = body.pose.position, shift(0.4, -0.7, 0.2);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.1, oblique));
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> coordinate(-1.5, 1.5);
  for (int i = 0; i < 200; ++i) {
    const Vector3d at(coordinate(random), coordinate(random), coordinate(random));
    const double before = signed_distance(specimen.shape, at);
    if (sampled && before > 0.2) continue;  // beyond the samples
    body.pose = {centre, Eigen::Quaterniond::Identity()};
    EXPECT_NEAR(signed_distance(body, at), before, tolerance);
    body.pose = {centre + shift, turn};
    EXPECT_NEAR(signed_distance(body, centre + shift + turn * (at - centre)), before, tolerance);
  }
  Eigen::AlignedBox3d reached;
  for (const Vector3d& point : specimen.surface.points)
    reached.extend(Vector3d(centre + shift + turn * (point - centre)));
  const Eigen::AlignedBox3d box = bounds(body);
  EXPECT_TRUE((box.min().array() <= reached.min().array() + 1e-7).all());
  EXPECT_TRUE((box.max().array() >= reached.max().array() - 1e-7).all());
  if (sampled) return;  // the box about the turned box
  EXPECT_LE((reached.min() - box.min()).maxCoeff(), specimen.surface.gap);
  EXPECT_LE((box.max() - reached.max()).maxCoeff(), specimen.surface.gap);
}

INSTANTIATE_TEST_SUITE_P(Solids, EveryBody, ::testing::ValuesIn(testing::specimens()),
                         [](const auto& tested) { return tested.param.name; });

TEST(Body, HasTheMassOfItsShape) {
  const Body body = make_body("brick", {brick}, 2000.0);
  EXPECT_NEAR(body.mass, 2000.0 * 1.0 * 0.6 * 0.2, 1e-10);
  EXPECT_NEAR(body.inertia(0, 0), body.mass / 3.0 * (0.09 + 0.01), 1e-10);
  EXPECT_EQ(body.pose.position, brick.centre);
  EXPECT_EQ(std::get<Box>(body.shape.geometry).centre, Vector3d::Zero());
  EXPECT_THROW(make_body("floor", {Plane{{0, 0, 0}, oblique}}, 1.0), std::invalid_argument);
}

TEST(Body, VelocityIsThatOfItsMaterial) {
  Body body = make_body("brick", {brick}, 1.0, Free{}, {{1, 2, 3}, {0.3, -0.2, 0.5}});
  const Vector3d in_body(0.2, 0.1, -0.4), at = body.pose.position + in_body;
  const Vector3d velocity = velocity_at(body, at);
  constexpr double dt = 1e-6;
  integrate(body, 0.0, dt);
  const Vector3d later = body.pose.position + body.pose.orientation * in_body;
  EXPECT_LT(((later - at) / dt - velocity).norm(), 1e-5);
}

TEST(Body, FreeFlightKeepsMomentumToRoundOffAndEnergyToSecondOrder) {
  const auto drift = [](int steps) {
    // About the axis of the middle inertia, where a body tumbles.
    Body body = make_body("brick", {brick}, 1000.0, Free{}, {{0.5, 0, 0}, {0.01, 5.0, 0.02}});
    const Vector3d momentum = angular_momentum(body);
    const double energy = turning_energy(body), duration = 4.0;
    double worst = 0.0, most_turned = 0.0;
    for (int i = 0; i < steps; ++i) {
      integrate(body, i * duration / steps, duration / steps);
      EXPECT_LT((angular_momentum(body) - momentum).norm(), 1e-11 * momentum.norm());
      worst = std::max(worst, std::abs(turning_energy(body) / energy - 1.0));
      most_turned = std::max(most_turned, -(body.pose.orientation * Vector3d::UnitY())[1]);
    }
    EXPECT_GT(most_turned, 0.9);  // it did turn over
    EXPECT_LT((body.pose.position - brick.centre - Vector3d(2.0, 0, 0)).norm(), 1e-12);
    return worst;
  };
  const double coarse = drift(2000), fine = drift(4000);
  EXPECT_LT(coarse, 1e-3);
  EXPECT_NEAR(coarse / fine, 4.0, 0.8);
}

TEST(Body, AFreeOneTurnsExactlyAboutAPrincipalAxis) {
  Body body = make_body("ball", {Sphere{{0, 0, 0}, 0.1}}, 1000.0, Free{}, {{0, 0, 0}, 3.0 * oblique});
  for (int i = 0; i < 10; ++i) integrate(body, 0.0, 0.1);
  EXPECT_LT(body.pose.orientation.angularDistance(Eigen::Quaterniond(Eigen::AngleAxisd(3.0, oblique))), 1e-7);
}

TEST(Body, AHingeHoldsItsPivotForAThousandTurns) {
  const Vector3d pivot(1.4, 2.0, 3.1);
  Body body = make_body("door", {brick}, 1000.0, Hinge{pivot, oblique}, {{0, 0, 0}, 2.0 * oblique});
  const Vector3d pivot_in_body = pivot - body.pose.position;
  EXPECT_LT(velocity_at(body, pivot).norm(), 1e-15);
  for (int i = 0; i < 100000; ++i) integrate(body, 0.0, 0.01 * pi);
  const Vector3d there = body.pose.position + body.pose.orientation * pivot_in_body;
  EXPECT_LT((there - pivot).norm(), 1e-10);
  EXPECT_LT((body.pose.position - brick.centre).norm(), 1e-9);  // whole turns
  EXPECT_NEAR(body.twist.angular_velocity.dot(oblique), 2.0, 1e-12);
}

TEST(Body, AHingedRodIsAPendulum) {
  const double length = 0.6, g = 9.81;
  const Shape rod{cylinder({0, 0, -length}, Vector3d::UnitZ(), 0.01, length)};
  Body body = make_body("rod", rod, 1000.0, Hinge{{0, 0, 0}, Vector3d::UnitY()});
  const double about_pivot = body.inertia(1, 1) + body.mass * 0.25 * length * length;
  // A force through the centre of mass turns it by its moment about the pivot.
  Eigen::Matrix<double, 6, 1> impulse = Eigen::Matrix<double, 6, 1>::Zero();
  impulse[0] = 1.0;
  const Eigen::Matrix<double, 6, 1> change = inverse_mass(body) * impulse;
  EXPECT_NEAR(change[4], -0.5 * length / about_pivot, 1e-10);
  EXPECT_NEAR(change[0], 0.25 * length * length / about_pivot, 1e-10);
  // Small swings have the period of a physical pendulum.
  body.twist = {{-0.5 * length * 0.01, 0, 0}, {0, 0.01, 0}};
  const double dt = 1e-3, period = 2.0 * pi * std::sqrt(about_pivot / (body.mass * g * 0.5 * length));
  double time = 0.0, last = 0.0;
  int crossings = 0;
  while (crossings < 4) {
    impulse << 0, 0, -dt * body.mass * g, 0, 0, 0;
    const Eigen::Matrix<double, 6, 1> kick = inverse_mass(body) * impulse;
    body.twist.velocity += kick.head<3>();
    body.twist.angular_velocity += kick.tail<3>();
    integrate(body, time, dt);
    time += dt;
    if (last * body.pose.position[0] < 0.0) ++crossings;
    last = body.pose.position[0];
  }
  EXPECT_NEAR(time, 2.0 * period, 0.01 * period);
}

TEST(Body, InverseMassIsThatOfTheMotion) {
  Body free = make_body("brick", {brick}, 1000.0);
  free.pose.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(0.8, oblique));
  const Matrix3d rotation = free.pose.orientation.toRotationMatrix();
  const Matrix3d turned = rotation * free.inertia * rotation.transpose();
  Eigen::Matrix<double, 6, 6> mass = Eigen::Matrix<double, 6, 6>::Zero();
  mass.topLeftCorner<3, 3>() = free.mass * Matrix3d::Identity();
  mass.bottomRightCorner<3, 3>() = turned;
  EXPECT_LT((inverse_mass(free) * mass - Eigen::Matrix<double, 6, 6>::Identity()).norm(), 1e-12);
  const Body moved = make_body("brick", {brick}, 1000.0, Prescribed{{{1, 0, 0}, {0, 0, 0}}});
  EXPECT_EQ(inverse_mass(moved).norm(), 0.0);
}

TEST(Body, PrescribedMotionStartsAndEndsOnTime) {
  const Prescribed motion{{{2.0, 0, 0}, {0, 0, 1.0}}, 1.0, 3.0};
  Body body = make_body("pusher", {brick}, 1000.0, motion);
  EXPECT_EQ(body.twist.velocity, Vector3d::Zero());
  integrate(body, 0.0, 0.9);
  EXPECT_EQ(body.pose.position, brick.centre);
  integrate(body, 0.9, 0.3);  // 0.2 of it in motion
  EXPECT_NEAR(body.pose.position[0], brick.centre[0] + 0.4, 1e-14);
  EXPECT_EQ(body.twist.velocity, Vector3d(2.0, 0, 0));
  EXPECT_EQ(body.twist.angular_velocity, Vector3d(0, 0, 1.0));
  integrate(body, 1.2, 5.0);
  EXPECT_NEAR(body.pose.position[0], brick.centre[0] + 4.0, 1e-14);
  EXPECT_LT(
      body.pose.orientation.angularDistance(Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Vector3d::UnitZ()))),
      1e-7);
  EXPECT_EQ(body.twist.velocity, Vector3d::Zero());
  const std::array bodies{make_body("brick", {brick}, 1.0), make_body("pusher", {brick}, 1.0, motion)};
  EXPECT_EQ(next_motion_change(bodies, 0.0), 1.0);
  EXPECT_EQ(next_motion_change(bodies, 1.0), 3.0);
  EXPECT_EQ(next_motion_change(bodies, 3.0), std::numeric_limits<double>::infinity());
  const Body at_once = make_body("pusher", {brick}, 1.0, Prescribed{motion.twist});
  EXPECT_EQ(at_once.twist.velocity, motion.twist.velocity);
}

TEST(Body, ThickeningIsWhatLacks) {
  const Body plate = make_body("plate", {Box{{0, 0, 0}, {1.0, 1.0, 0.01}}}, 1000.0);
  EXPECT_NEAR(thickening(plate, 0.1), 0.04, 1e-15);
  EXPECT_EQ(thickening(plate, 0.02), 0.0);
  EXPECT_EQ(thickening(plate, 0.0), 0.0);
}

}  // namespace
}  // namespace talus
