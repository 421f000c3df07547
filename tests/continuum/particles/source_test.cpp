// Inlets: how much enters, where, when, and that steps of any length let in the same.
#include "continuum/particles/source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

namespace talus {
namespace {

using Eigen::Vector3d;

const std::vector<Material> materials{{"light", 1000.0, 0.5, 0.5, {}}, {"heavy", 2500.0, 0.6, 0.5, {}}};

/// A level inlet of 0.2 m x 0.1 m that lets in sand from 0.25 s on.
Source inlet() {
  return {1, {0.1, 0.2, 0.9}, {0.3, 0.3, 0.9}, false, {0.3, 0.0, -2.0}, 0.8, 0.25, 1e9, 0.01};
}
constexpr double interval = 0.01 / 2.0;  // s, between layers
constexpr double layer_mass = 1500.0 * 0.8 * 0.2 * 0.1 * 0.01;

/// What has entered at the end of steps that end at `times`, each particle moved on with its velocity.
Particles entered(Source source, const std::vector<double>& times) {
  Particles particles;
  particles.resize(0);
  std::vector<Source> sources{source};
  double now = 0.0, mass = 0.0;
  Eigen::Index count = 0;
  for (const double time : times) {
    particles.positions += (time - now) * particles.velocities;
    const EmissionReport report = emit(materials, time, sources, particles);
    mass += report.mass;
    count += report.count;
    now = time;
  }
  EXPECT_EQ(count, particles.count());
  EXPECT_NEAR(mass, particles.masses.sum(), 1e-12 * mass);
  return particles;
}

TEST(Source, MassIsDensityTimesFillTimesAreaTimesSpeedTimesTime) {
  for (const double duration : {0.1, 0.333, 1.0}) {
    const double mass = entered(inlet(), {0.25 + duration}).masses.sum();
    EXPECT_NEAR(mass, 1500.0 * 0.8 * (0.2 * 0.1) * 2.0 * duration, 1.0001 * layer_mass) << duration;
  }
}

TEST(Source, AnEllipseHasTheEllipsesMass) {
  Source source = inlet();
  source.round = true;
  const Particles particles = entered(source, {0.25 + 10.1 * interval});
  EXPECT_NEAR(particles.masses.sum(), 10.0 * std::numbers::pi / 4.0 * layer_mass, 1e-10);
  const Eigen::ArrayXd x =
      (particles.positions.row(1).array() - 0.25) / 0.05;  // the axis that is not blown along
  EXPECT_LT(x.abs().maxCoeff(), 1.0);
  // Fewer than a rectangle has, as many as the ellipse holds.
  EXPECT_NEAR(static_cast<double>(particles.count()), 10 * 200 * std::numbers::pi / 4.0, 10 * 12);
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    const double back = (0.9 - particles.positions(2, p)) / 2.0;  // s since it entered
    const double u = (particles.positions(0, p) - 0.3 * back - 0.2) / 0.1,
                 v = (particles.positions(1, p) - 0.25) / 0.05;
    EXPECT_LE(u * u + v * v, 1.0 + 1e-9);
  }
}

TEST(Source, ParticlesFillTheirInletAndCarryItsVelocityAndMaterial) {
  const Particles particles = entered(inlet(), {0.25 + 3.1 * interval});
  ASSERT_EQ(particles.count(), 3 * 20 * 10);
  EXPECT_EQ((particles.velocities.colwise() - Vector3d(0.3, 0.0, -2.0)).norm(), 0.0);
  EXPECT_EQ(particles.gradients.norm(), 0.0);
  EXPECT_TRUE(
      std::all_of(particles.materials.begin(), particles.materials.end(), [](int m) { return m == 1; }));
  EXPECT_NEAR(particles.positions.row(1).minCoeff(), 0.205, 1e-12);
  EXPECT_NEAR(particles.positions.row(1).maxCoeff(), 0.295, 1e-12);
  EXPECT_NEAR(particles.positions.row(1).mean(), 0.25, 1e-12);
  // Its own volume m / rho_max, as a sphere.
  const double volume = particles.masses[0] / 1500.0;
  EXPECT_NEAR(particles.shapes(0, 5), std::pow(0.75 * volume / std::numbers::pi, 2.0 / 3.0), 1e-15);
  EXPECT_EQ(particles.shapes(3, 5), 0.0);
}

TEST(Source, LayersAreOneSpacingApart) {
  const Particles particles = entered(inlet(), {0.25 + 7.2 * interval});
  std::vector<double> heights(particles.positions.row(2).begin(), particles.positions.row(2).end());
  std::sort(heights.begin(), heights.end());
  ASSERT_EQ(heights.size(), 7u * 200u);
  // All of the youngest had passed the inlet 0.2 intervals ago, its middle half an interval before.
  EXPECT_NEAR(heights.back(), 0.9 - 0.7 * 0.01, 1e-12);
  for (std::size_t layer = 0; layer < 7; ++layer) {
    EXPECT_NEAR(heights[200 * layer], heights[200 * layer + 199], 1e-12);
    if (layer == 0) continue;
    EXPECT_NEAR(heights[200 * layer] - heights[200 * layer - 1], 0.01, 1e-12);
  }
}

TEST(Source, NothingEntersBeforeItsStartOrAfterItsEnd) {
  Source source = inlet();
  source.end = 0.35;
  EXPECT_EQ(entered(source, {0.1, 0.25}).count(), 0);
  EXPECT_NEAR(source.next_layer_time(), 0.25 + interval, 1e-15);
  EXPECT_EQ(entered(source, {source.next_layer_time()}).count(), 200);
  const double mass = entered(source, {0.3, 0.35, 0.4, 7.0}).masses.sum();
  EXPECT_NEAR(mass, 20.0 * layer_mass, 1e-10);
  source.layers = 20;
  EXPECT_EQ(source.next_layer_time(), std::numeric_limits<double>::infinity());
}

TEST(Source, StepsOfAnyLengthLetInTheSame) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const Particles once = entered(inlet(), {0.5011});
  ASSERT_EQ(once.count(), 50 * 200);
  for (int trial = 0; trial < 20; ++trial) {
    const double longest = 0.03 * std::pow(unit(random), 2);
    std::vector<double> times{0.2 * unit(random)};
    while (times.back() < 0.5011)
      times.push_back(std::min(0.5011, times.back() + 1e-5 + longest * unit(random)));
    const Particles stepped = entered(inlet(), times);
    ASSERT_EQ(stepped.count(), once.count());  // and in the same order
    EXPECT_LT((stepped.positions - once.positions).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_TRUE((stepped.masses == once.masses).all());
  }
}

TEST(Source, InletsOfAllDirections) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double speed : {-1.0, 1.0}) {
      Source source = inlet();
      source.lower = Vector3d(0.1, 0.2, 0.3);
      source.upper = source.lower + 0.1 * (Vector3d::Ones() - Vector3d::Unit(axis));
      source.velocity = speed * Vector3d::Unit(axis);
      EXPECT_EQ(source.normal(), axis);
      const Particles particles = entered(source, {0.25 + 0.0401});  // four layers
      ASSERT_EQ(particles.count(), 4 * 100);
      const Eigen::ArrayXd beyond = speed * (particles.positions.row(axis).array() - source.lower[axis]);
      EXPECT_NEAR(beyond.minCoeff(), 0.0051, 1e-12);
      EXPECT_NEAR(beyond.maxCoeff(), 0.0351, 1e-12);
    }
  }
}

}  // namespace
}  // namespace talus
