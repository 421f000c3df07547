// One step at a time: where steps end, gates that open, sources that start, and what rate dependence does to a flow.
#include "continuum/step.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

#include "continuum/io/budget.h"
#include "continuum/parallel.h"
#include "tests/continuum/particles/particle_sums.h"
#include "tests/continuum/scenes.h"

namespace talus {
namespace {

using Eigen::Vector3d;
using testing::gravity;

constexpr double h = 0.01;  // m

/// Sand three cells deep on a gate that goes across a shaft; below it, air down to a floor.
Scene shaft(double opens_at) {
  Scene scene = testing::box_scene({3, 1, 12}, {1.0, 1.0, 1.0}, h, 0.5);
  scene.grid.periodic[1] = true;
  scene.sides[0] = {Side{true, 0.0}, Side{true, 0.0}};
  scene.sides[2][0] = {true, 0.5};
  scene.fillings = {testing::box_of(0, h * Vector3d(0, 0, 8), h * Vector3d(3, 1, 11))};
  scene.walls = {{testing::box_of(0, h * Vector3d(-5, -5, 6), h * Vector3d(8, 6, 8)).shape, 0.3, opens_at}};
  return scene;
}

double lowest(const State& state) { return state.particles.positions.row(2).minCoeff(); }

TEST(Gate, HoldsTheSandUntilItOpensAndNoLonger) {
  constexpr double opens_at = 0.0613;
  State state = initial_state(shaft(opens_at));
  const double mass = state.particles.masses.sum();
  testing::run_for(state, StepSettings{}, opens_at,
                   [&](const State&, const StepReport&) { EXPECT_GE(lowest(state), 8.0 * h - 1e-9 * h); });
  EXPECT_LT(std::abs(testing::mean_velocity(state, 2)), 0.02);
  const double height = state.particles.positions.row(2).mean();
  constexpr double fall = 0.05;  // s
  testing::run_for(state, StepSettings{}, fall, [](const State&, const StepReport&) {});
  EXPECT_NEAR(testing::mean_velocity(state, 2), -gravity * fall, 0.1 * gravity * fall);
  EXPECT_NEAR(state.particles.positions.row(2).mean() - height, -0.5 * gravity * fall * fall, 0.2 * h);
  EXPECT_LT(lowest(state), 7.0 * h);
  EXPECT_NEAR(state.particles.masses.sum(), mass, 1e-12 * mass);
  EXPECT_FALSE(state.openings.any());
}

TEST(Gate, AStepEndsWhenItOpensAndTheNextIsCold) {
  constexpr double opens_at = 0.0613;
  State state = initial_state(shaft(opens_at));
  StepSettings settings;
  settings.projection.iterations = 1;
  settings.projection.cold_iterations = 5;
  int problems = 0;  // two for each staggered iteration
  settings.projection.record = [&](const Problem&) { ++problems; };
  settings.packing_tolerance = 1.0;  // no packing problems among them
  int at_gate = 0;
  for (int i = 0; state.time < 0.09; ++i) {
    const double start = state.time;
    const bool cold = i == 0 || start == opens_at;
    problems = 0;
    step(state, settings, 0.09 - state.time);
    EXPECT_FALSE(start < opens_at && state.time > opens_at) << start << " to " << state.time;
    EXPECT_EQ(problems, cold ? 10 : 2) << start;
    EXPECT_EQ(state.openings.any(), state.time < opens_at);
    EXPECT_EQ(state.contact_changed, state.time == opens_at);
    at_gate += state.time == opens_at;
    ASSERT_LT(i, 200);
  }
  EXPECT_EQ(at_gate, 1);
}

/// A block of sand in free flight, its particles swinging against each other too finely for the grid to see.
State shimmering_block() {
  State state = initial_state(testing::box_scene({10, 10, 10}, {6.0, 6.0, 6.0}, h, 0.5));
  for (Eigen::Index p = 0; p < state.particles.count(); ++p) {
    const Eigen::Vector3d place = state.particles.positions.col(p) / (0.5 * h);
    const bool odd =
        static_cast<long>(std::floor(place[0]) + std::floor(place[1]) + std::floor(place[2])) % 2;
    state.particles.velocities(0, p) = odd ? 1e-3 : -1e-3;
  }
  return state;
}

TEST(TimeStep, IsShortForSandThatGoesAndNotForWhatParticlesKeepForThemselves) {
  constexpr double speed = 1.0;  // m/s
  const StepSettings settings;
  State state = shimmering_block();
  state.particles.velocities.row(0) *= speed / 1e-3;
  const double longest = settings.gravity_courant * std::sqrt(h / gravity);
  ASSERT_LT(settings.courant * h / speed, 0.6 * longest);
  EXPECT_NEAR(step(state, settings, longest).dt, longest, 1e-9 * longest);

  State flying = shimmering_block();
  flying.particles.velocities.row(0).setConstant(speed);
  const double dt = step(flying, settings, longest).dt;
  EXPECT_LE(dt, settings.courant * h / speed);
  EXPECT_GE(dt, 0.3 * settings.courant * h / speed);
}

TEST(RelativeTolerance, ChangesNothingWhereSandIsNotThrown) {
  std::vector<Eigen::Matrix3Xd> after;
  for (const double relative : {0.0, ProjectionSettings{}.relative_tolerance}) {
    State state = initial_state(shaft(0.01));
    StepSettings settings;
    settings.projection.relative_tolerance = relative;
    testing::run_for(state, settings, 0.1, [](const State&, const StepReport&) {});
    after.push_back(state.particles.positions);
  }
  EXPECT_EQ(after[0], after[1]);
}

TEST(TimeStep, HalfAsLongTakesTwiceAsManyStepsAndDampsNoMore) {
  double left[2];
  int steps[2] = {0, 0};
  for (const int half : {0, 1}) {
    State state = shimmering_block();
    state.gravity = {0.0, 0.0, -0.1};  // so that no step is short for speed
    StepSettings settings;
    settings.reshape = false;
    settings.pic_share = 0.3;
    settings.courant *= half ? 0.5 : 1.0;
    settings.gravity_courant *= half ? 0.5 : 1.0;
    const double longest = settings.gravity_courant * std::sqrt(h / 0.1);
    testing::run_for(state, settings, 0.4, [&](const State&, const StepReport& report) {
      EXPECT_LE(report.dt, longest * (1.0 + 1e-9));
      ++steps[half];
    });
    left[half] = state.particles.velocities.row(0).norm();
  }
  EXPECT_NEAR(steps[1], 2 * steps[0], 1);
  EXPECT_GT(left[0], 0.0);
  // (1 - 0.3)^n against (1 - 0.15)^2n.
  EXPECT_NEAR(std::log(left[1] / left[0]), steps[0] * std::log(0.85 * 0.85 / 0.7), 0.02 * steps[0]);
}

TEST(Defects, LeaveTheirMark) {
  const auto after = [](const StepSettings& settings) {
    Scene scene = testing::box_scene({24, 1, 16}, {6.0, 1.0, 6.0}, h, 0.5);
    scene.grid.periodic[1] = true;
    scene.sides[0][0] = {true, 0.0};
    scene.sides[2][0] = {true, 0.5};
    for (Filling& filling : scene.fillings) filling.velocity = {0.0, 0.0, -1.0};
    State state = initial_state(scene);
    double peak = 0.0;
    bool pulled = false;
    testing::run_for(state, settings, 0.1, [&](const State& now, const StepReport& report) {
      peak = std::max(peak, report.packing.peak_fill);
      pulled = pulled || pressure_of(now.warm->stress).minCoeff() < 0.0;
      EXPECT_EQ(report.cap_hits(), 0);
    });
    return std::pair{peak, pulled};
  };
  StepSettings pulls, overfull;
  pulls.projection.pressure_pulls = true;
  overfull.packing_tolerance = std::numeric_limits<double>::infinity();
  const auto [sound_peak, sound_pulled] = after({});
  EXPECT_FALSE(sound_pulled);
  EXPECT_TRUE(after(pulls).second);
  EXPECT_GT(after(overfull).first, sound_peak + 0.05);
}

/// An empty domain takes its steps from one event to the next, or to where it is told to.
State empty_domain(int cells = 10) {
  Scene scene = testing::box_scene(Eigen::Vector3i::Constant(cells), {1.0, 1.0, 1.0}, h, 0.5);
  scene.fillings.clear();
  return initial_state(scene);
}

TEST(Events, AreMetToTheLastBit) {
  volatile double start = 0.003, opens_at = 0.013;
  ASSERT_LT(start + (opens_at - start), opens_at);  // in floating point
  State state = empty_domain(1);
  state.walls = {{Shape{Plane{Vector3d::Zero(), Vector3d::UnitZ()}}, 0.3, opens_at}};
  state.openings = openings_of(state.grid, state.walls, 0.0);
  step(state, StepSettings{}, start);
  EXPECT_TRUE(state.openings.any());
  step(state, StepSettings{}, 1.0);
  EXPECT_EQ(state.time, opens_at);
  EXPECT_FALSE(state.openings.any());
}

TEST(Events, NoSliverOfAStepIsLeftBeforeThem) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int trial = 0; trial < 300; ++trial) {
    State state = empty_domain(1);
    const double opens_at = 0.01 + unit(random);
    state.walls = {{Shape{Plane{Vector3d::Zero(), Vector3d::UnitZ()}}, 0.3, opens_at}};
    state.openings = openings_of(state.grid, state.walls, 0.0);
    bool opened = false;
    const double end = 1.1;
    while (state.time < end) {
      const double start = state.time, limit = std::min(end - start, 1e-4 + 0.3 * std::pow(unit(random), 3));
      const StepReport report = step(state, StepSettings{}, limit);
      EXPECT_GE(report.dt, std::min(limit, opens_at > start ? opens_at - start : limit) * (1.0 - 1e-6));
      EXPECT_GT(report.dt, 1e-12) << opens_at;
      opened = opened || state.time == opens_at;
    }
    EXPECT_TRUE(opened) << opens_at;
    EXPECT_FALSE(state.openings.any());
  }
}

/// Lets sand fall in through a square of 4 x 4 cells.
Source inlet_at(double height, double start) {
  return {0, {0.03, 0.03, height}, {0.07, 0.07, height}, false, {0.0, 0.0, -0.5}, 1.0, start, 1e9, 0.5 * h};
}

TEST(SourceInStep, AnEmptyDomainStepsToTheFirstLayer) {
  State state = empty_domain();
  state.sources = {inlet_at(0.08, 0.3)};
  const double first = state.sources[0].next_layer_time();
  EXPECT_EQ(step(state, StepSettings{}, 0.2).dt, 0.2);
  const StepReport report = step(state, StepSettings{}, 10.0);
  EXPECT_EQ(state.time, first);
  EXPECT_EQ(state.particles.count(), 64);
  EXPECT_NEAR(report.mass_added, 1500.0 * 0.04 * 0.04 * 0.5 * h, 1e-12);
  EXPECT_NEAR(state.particles.positions.row(2).mean(), 0.08 - 0.25 * h, 1e-12);
}

TEST(SourceInStep, AnInletOnTheDomainsSideLosesNothing) {
  for (const double top : {0.1, 0.0}) {
    State state = empty_domain();
    state.gravity.setZero();
    state.sources = {inlet_at(top, 0.0)};
    state.sources[0].velocity[2] = top > 0.0 ? -0.5 : 0.5;
    const double start = state.particles.masses.sum();
    double added = 0.0, left = 0.0;
    testing::run_for(state, StepSettings{}, 0.051, [&](const State& now, const StepReport& report) {
      added += report.mass_added;
      left += report.mass_left;
      for (Eigen::Index p = 0; p < now.particles.count(); ++p)
        ASSERT_TRUE(now.grid.contains(now.particles.positions.col(p))) << now.particles.positions.col(p);
    });
    EXPECT_EQ(start, 0.0);
    EXPECT_EQ(left, 0.0);
    EXPECT_NEAR(added, 5.0 * 1500.0 * 0.04 * 0.04 * 0.5 * h, 1e-12);
    EXPECT_NEAR(state.particles.masses.sum(), added, 1e-12);
  }
}

TEST(SourceInStep, WhatIsBlownOutOfTheDomainHasLeft) {
  State state = empty_domain();
  state.sources = {inlet_at(0.0995, 0.0)};
  state.sources[0].velocity[2] = 0.5;  // upwards, out of the open top
  Budget budget(state);
  testing::run_for(state, StepSettings{}, 0.05, [&](const State& now, const StepReport& report) {
    for (Eigen::Index p = 0; p < now.particles.count(); ++p)
      ASSERT_TRUE(now.grid.contains(now.particles.positions.col(p))) << now.particles.positions.col(p);
    budget.add(now, report);
  });
  EXPECT_NEAR(budget.summary()["mass_error"].get<double>(), 0.0, 1e-12);
  EXPECT_GT(budget.summary()["mass_left_kg"].get<double>(), 0.0);
}

TEST(SourceInStep, TheMassBudgetClosesWithAnOpenOutflow) {
  State state = empty_domain();
  state.sources = {inlet_at(0.08, 0.01)};
  state.sources[0].end = 0.15;
  Budget budget(state);
  double time = 0.0;
  testing::run_for(state, StepSettings{}, 0.4, [&](const State& now, const StepReport& report) {
    budget.add(now, report);
    time += report.dt;
    EXPECT_NEAR(now.time, time, 1e-12);
  });
  const auto sums = budget.summary();
  EXPECT_NEAR(sums["mass_error"].get<double>(), 0.0, 1e-12);
  EXPECT_EQ(sums["mass_kg"], 0.0);
  // 0.14 s of half a metre a second: 14 layers.
  EXPECT_NEAR(sums["mass_added_kg"].get<double>(), 14 * 1500.0 * 0.04 * 0.04 * 0.5 * h, 1e-12);
  EXPECT_NEAR(sums["mass_left_kg"].get<double>(), sums["mass_added_kg"].get<double>(), 1e-12);
  EXPECT_EQ(state.particles.count(), 0);  // all of it fell out of the open floor
  EXPECT_EQ(sums["cap_hits"], 0);
}

/// Mean acceleration, in g, of a layer on a rough incline whose slope is `slope`; periodic along it.
double acceleration_on_incline(double slope, const RateDependence& rate, double duration) {
  Scene scene = testing::box_scene({4, 1, 8}, {4.0, 1.0, 4.0}, h, 0.4);
  scene.grid.periodic = {true, true, false};
  scene.sides[2][0] = {true, as_rough_as_sand};
  const double angle = std::atan(slope);
  scene.gravity = gravity * Vector3d(std::sin(angle), 0.0, -std::cos(angle));
  scene.materials[0].rate = rate;
  State state = initial_state(scene);
  // It starts sheared, as a layer flows.
  state.particles.velocities.row(0) = 10.0 * state.particles.positions.row(2);
  const double start = testing::mean_velocity(state, 0);
  testing::run_for(state, StepSettings{}, duration, [](const State&, const StepReport&) {});
  return (testing::mean_velocity(state, 0) - start) / (duration * gravity);
}

TEST(RateDependentFriction, ALayerOnARoughInclineAcceleratesLess) {
  // Half-way between mu_1 = 0.4 and mu_2 = 0.8.
  const double constant = acceleration_on_incline(0.6, {}, 0.1);
  const double dependent = acceleration_on_incline(0.6, {0.8, 0.1, 0.002}, 0.1);
  std::printf("[ measured ] acceleration / g: constant %.4f, mu(I) %.4f\n", constant, dependent);
  // g (sin - mu_1 cos), in units of g.
  EXPECT_NEAR(constant, (0.6 - 0.4) / std::sqrt(1.36), 0.02);
  EXPECT_LT(dependent, 0.7 * constant);
}

TEST(StepBesideWalls, NothingIsLostOverAPeriodicSeam) {
  Scene scene = testing::box_scene({10, 10, 6}, {10.0, 10.0, 5.0}, 0.01, 0.5);
  scene.grid.periodic = {true, true, false};
  scene.sides[2] = {Side{true, 0.5}, Side{true, 0.5}};
  // A ball beside the seam, which puts back over it what moves into its far side.
  scene.walls = {{Shape{Sphere{{0.01, 0.05, 0.03}, 0.02}}, 0.3}};
  State state = initial_state(scene);
  state.particles.velocities.row(0).setConstant(0.5);
  Eigen::Index left = 0, collisions = 0;
  testing::run_for(state, StepSettings{}, 0.1, [&](const State&, const StepReport& report) {
    left += report.particles_left;
    collisions += report.collisions.count;
  });
  EXPECT_EQ(left, 0);
  EXPECT_GT(collisions, 0);
}

TEST(StepBesideWalls, SandShutInOnEverySideHasFiniteBooks) {
  Scene scene = testing::box_scene({1, 1, 1}, {1.0, 1.0, 1.0}, 0.01, 0.5);
  for (auto& axis : scene.sides) axis = {Side{true, 0.5}, Side{true, 0.5}};
  State state = initial_state(scene);
  const StepReport report = step(state, StepSettings{}, 0.001);
  EXPECT_EQ(report.projection.friction_residual, 0.0);
  EXPECT_EQ(report.cap_hits(), 0);
}

Vector3d momentum_of(const Particles& particles) { return particles.velocities * particles.masses.matrix(); }

/// Sand on a floor, against a wall, beside a fixed ball, and under a heavy one that is free.
State supported_sand() {
  Scene scene = testing::box_scene({14, 12, 10}, {7.0, 12.0, 6.0}, h, 0.5);
  scene.sides[0] = {Side{true, 0.0}, Side{true, 0.3}};
  scene.sides[1] = {Side{true, 0.3}, Side{true, 0.3}};
  scene.sides[2][0] = {true, 0.5};
  scene.walls = {{Shape{Sphere{{0.09, 0.05, 0.0}, 0.02}}, 0.3}};
  scene.jitter = 0.5;
  State state = initial_state(scene);
  add_bodies(state, {make_body("ball", Shape{Sphere{{0.03, 0.06, 0.085}, 0.02}}, 8000.0, Free{}, {})});
  return state;
}

TEST(SolidsImpulse, IsWhatTheMomentumOfSandLacksWithGravity) {
  for (const Transfer transfer : {Transfer::flip, Transfer::apic}) {
    State state = supported_sand();
    StepSettings settings;
    settings.transfer = transfer;
    const double mass = state.particles.masses.sum();
    Vector3d before = momentum_of(state.particles);
    double pushed = 0.0;
    testing::run_for(state, settings, 0.2, [&](const State& now, const StepReport& report) {
      const Vector3d after = momentum_of(now.particles);
      const Vector3d expected = after - before - report.dt * mass * now.gravity - report.collisions.impulse;
      EXPECT_LT((report.solids_impulse - expected).norm(), 1e-9 * mass * gravity * report.dt);
      before = after;
      pushed = std::max(pushed, report.on_bodies[0].linear[2]);
    });
    EXPECT_GT(pushed, 0.0);
  }
}

TEST(SolidsImpulse, BearsTheWeightOfSandAtRest) {
  State state = supported_sand();
  const double weight = state.particles.masses.sum() * gravity;
  testing::run_for(state, StepSettings{}, 0.8, [](const State&, const StepReport&) {});
  Vector3d impulse = Vector3d::Zero();
  constexpr double time = 0.1;
  testing::run_for(state, StepSettings{}, time, [&](const State&, const StepReport& report) {
    impulse += report.solids_impulse + report.collisions.impulse;
  });
  EXPECT_NEAR(impulse[2] / (time * weight), 1.0, 0.01);
  EXPECT_NEAR(impulse[0] / (time * weight), 0.0, 0.01);
}

/// A heap beside a ball that collapses, after some steps on `threads`.
State collapsed(int threads, Transfer transfer) {
  Scene scene = testing::box_scene({14, 12, 10}, {7.0, 12.0, 8.0}, 0.01, 0.5);
  scene.grid.periodic[1] = true;
  scene.sides[0] = {Side{true, 0.0}, Side{true, 0.3}};
  scene.sides[2][0] = {true, 0.5};
  scene.walls = {{Shape{Sphere{{0.09, 0.05, 0.0}, 0.02}}, 0.3}};
  scene.jitter = 0.5;
  set_thread_count(threads);
  State state = initial_state(scene);
  StepSettings settings;
  settings.transfer = transfer;
  for (int i = 0; i < 6; ++i) step(state, settings, 1.0);
  set_thread_count(1);
  return state;
}

TEST(StepInThreads, IsTheSameBitForBit) {
  for (const Transfer transfer : {Transfer::flip, Transfer::apic}) {
    const State one = collapsed(1, transfer), two = collapsed(2, transfer);
    EXPECT_TRUE(testing::identical(one.particles, two.particles));
    EXPECT_GT(one.particles.velocities.cwiseAbs().maxCoeff(), 0.1);
  }
}

}  // namespace
}  // namespace talus
