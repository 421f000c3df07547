// Render points through whole steps: the simulation does not know of them, none gets lost, and threads change nothing.
#include <gtest/gtest.h>

#include <map>

#include "continuum/parallel.h"
#include "continuum/particles/render_point_places.h"
#include "continuum/step.h"
#include "tests/continuum/particles/particle_sums.h"
#include "tests/continuum/scenes.h"

namespace talus {
namespace {

using Eigen::Vector3d;

constexpr double h = 0.01;  // m
constexpr int each = 8;     // points of a particle

/// A column that collapses on a rough floor between a wall and an open side, over which some of it is lost; a source above;
/// periodic across.
Scene collapse() {
  Scene scene = testing::box_scene({12, 4, 14}, {5.0, 4.0, 8.0}, h, 0.5);
  scene.grid.periodic[1] = true;
  scene.sides[0][0] = {true, 0.3};
  scene.sides[2][0] = {true, 0.5};
  scene.sources = {
      {0, {0.06, 0.0, 0.13}, {0.1, 0.04, 0.13}, false, {0.3, 0.0, -1.0}, 1.0, 0.0, 0.06, 0.5 * h}};
  scene.jitter = 0.5;
  scene.render_points_per_particle = each;
  return scene;
}

/// Calls observe(state, report) after each step.
template <class Observe>
State run(const Scene& scene, double duration, const Observe& observe) {
  State state = initial_state(scene);
  testing::run_for(state, StepSettings{}, duration, observe);
  return state;
}

State run(const Scene& scene, double duration) {
  return run(scene, duration, [](const State&, const StepReport&) {});
}

TEST(RenderPointsInStep, LeaveTheSimulationAsItIsBitForBit) {
  Scene scene = collapse();
  const State with = run(scene, 0.15);
  scene.render_points_per_particle = 0;
  const State without = run(scene, 0.15);
  EXPECT_TRUE(testing::identical(with.particles, without.particles));
  EXPECT_EQ(with.time, without.time);
  EXPECT_FALSE(with.particles.has_origins());
  EXPECT_GT(with.render_points.count(), 0);
  EXPECT_EQ(without.render_points.count(), 0);
  EXPECT_EQ(without.render_points.particle_count(), 0);
}

TEST(RenderPointsInStep, NoneIsMadeOrLostWithoutReason) {
  std::int64_t count = initial_state(collapse()).render_points.count();
  HandOverReport all;
  Eigen::Index reshaped = 0;
  double mass_left = 0.0;
  const State state = run(collapse(), 0.3, [&](const State& now, const StepReport& report) {
    const HandOverReport& points = report.render_points;
    const RenderPoints& drawn = now.render_points;
    count += points.added - points.hidden - points.departed;
    EXPECT_EQ(drawn.count(), count);
    EXPECT_EQ(drawn.particle_count(), now.particles.count());
    EXPECT_EQ(drawn.first.back(), count);
    EXPECT_EQ(drawn.identities.size(), drawn.offsets.size());
    all += points;
    reshaped += report.reshape.split.splits + report.reshape.merge.merges;
    mass_left += report.mass_left;
  });
  EXPECT_GT(reshaped, 100);
  EXPECT_GT(mass_left, 0.0);
  EXPECT_GT(all.added, 0);  // by the source
  EXPECT_GT(all.departed, 0);
  EXPECT_GT(all.resampled, 0);
  EXPECT_LT(all.resampled, count / 10);  // in all steps together
  // A point stands for the same mass everywhere but where it is hidden.
  double mass_shown = 0.0;
  for (Eigen::Index p = 0; p < state.particles.count(); ++p)
    mass_shown += state.render_points.hidden[static_cast<std::size_t>(p)] ? 0.0 : state.particles.masses[p];
  const double due = mass_shown / (1500.0 * h * h * h / 8.0) * each;
  EXPECT_NEAR(static_cast<double>(state.render_points.count()), due, 0.05 * due);
}

TEST(RenderPointsInStep, AParticleThatNeverSplitsKeepsItsOwn) {
  Scene scene = collapse();
  scene.sources.clear();
  State state = initial_state(scene);
  StepSettings settings;
  settings.reshape = false;
  testing::tag(state);
  const auto points_by_tag = [&] {
    std::map<double, std::pair<std::int64_t, std::uint32_t>>
        points;  // how many, and the first one's identity
    for (std::size_t p = 0; p < state.render_points.hidden.size(); ++p) {
      const std::int64_t first = state.render_points.first[p],
                         count = state.render_points.first[p + 1] - first;
      EXPECT_TRUE(count == each || (count == 0 && state.render_points.hidden[p]));
      if (count > 0)
        points[state.particles.masses[static_cast<Eigen::Index>(p)]] = {
            count, state.render_points.identities[static_cast<std::size_t>(first)]};
    }
    return points;
  };
  const auto before = points_by_tag();
  testing::run_for(state, settings, 0.05, [](const State&, const StepReport&) {});
  std::size_t kept = 0;
  for (const auto& [tag, points] : points_by_tag()) {
    const auto then = before.find(tag);
    kept += then != before.end() && then->second == points;
  }
  EXPECT_GT(kept, before.size() * 9 / 10);  // the others were buried in between
}

TEST(RenderPointsInStep, NeitherNotFoundOutsideNorFarFromTheirParent) {
  const State state = run(collapse(), 0.2);
  const Eigen::Matrix3Xf positions = render_positions(state.grid, state.particles, state.render_points);
  EXPECT_GE(positions.row(0).minCoeff(), -1e-6f * h);
  EXPECT_GE(positions.row(2).minCoeff(), -1e-6f * h);
  EXPECT_GE(positions.row(1).minCoeff(), 0.0f);
  EXPECT_LT(positions.row(1).maxCoeff(), 4.0f * static_cast<float>(h) * (1.0f + 1e-6f));
  const Surroundings around{state.grid, state.sides, state.openings, nullptr, {}};
  double furthest = 0.0;  // q^2
  for (std::size_t p = 0; p < state.render_points.hidden.size(); ++p) {
    const Parent parent(around, state.particles, static_cast<Eigen::Index>(p));
    for (auto k = state.render_points.first[p]; k < state.render_points.first[p + 1]; ++k) {
      const Vector3d offset = state.render_points.offsets[static_cast<std::size_t>(k)].cast<double>();
      const double squared = parent.squared_distance(offset);
      EXPECT_LE(squared, farthest_offset * farthest_offset * (1.0 + 1e-5));
      furthest = std::max(furthest, squared);
    }
  }
  EXPECT_GT(furthest, 1.0);  // some are beyond where they are sampled
}

TEST(RenderPointsInStep, ThreadsChangeNothing) {
  const auto with_threads = [](int threads) {
    set_thread_count(threads);
    State state = run(collapse(), 0.08);
    set_thread_count(1);
    return state;
  };
  const State one = with_threads(1), three = with_threads(3);
  EXPECT_TRUE(testing::identical(one.particles, three.particles));
  EXPECT_EQ(one.render_points.offsets, three.render_points.offsets);
  EXPECT_EQ(one.render_points.identities, three.render_points.identities);
  EXPECT_EQ(one.render_points.first, three.render_points.first);
  EXPECT_EQ(one.render_points.hidden, three.render_points.hidden);
}

TEST(RenderPointsInStep, TheSeedSaysWhereTheyAre) {
  Scene scene = collapse();
  scene.jitter = 0.0;
  const State first = initial_state(scene), same = initial_state(scene);
  scene.seed = 2;
  const State other = initial_state(scene);
  EXPECT_EQ(first.render_points.offsets, same.render_points.offsets);
  EXPECT_TRUE(testing::identical(first.particles, other.particles));
  EXPECT_NE(first.render_points.offsets, other.render_points.offsets);
}

TEST(RenderPointsInStep, AnEmptyDomainHasNoneUntilSandEnters) {
  Scene scene = collapse();
  scene.fillings.clear();
  scene.grid.cells[0] = 14;
  State state = initial_state(scene);
  EXPECT_EQ(state.render_points.count(), 0);
  EXPECT_TRUE(state.render_points.wanted());
  const StepReport report = step(state, StepSettings{}, 1.0);
  EXPECT_GT(state.particles.count(), 0);
  EXPECT_EQ(report.render_points.added, state.render_points.count());
  EXPECT_EQ(state.render_points.count(), each * state.particles.count());
  // And when all of it has left again.
  state.sources.clear();
  state.sides[0][0].wall = state.sides[2][0].wall = false;
  for (int i = 0; i < 1000 && state.particles.count() > 0; ++i) step(state, StepSettings{}, 1.0);
  step(state, StepSettings{}, 1.0);
  EXPECT_EQ(state.particles.count(), 0);
  EXPECT_EQ(state.render_points.count(), 0);
}

TEST(RenderPointsInStep, ThoseOfOtherParticlesAreRefused) {
  State state = initial_state(collapse());
  state.particles.resize(state.particles.count() - 1);
  EXPECT_THROW(step(state, StepSettings{}, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace talus
