// Splitting and merging: when they happen, when they do not, and that one undoes the other.
#include "continuum/particles/reshape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "continuum/particles/deform.h"
#include "tests/continuum/particles/particle_sums.h"

namespace talus {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::add_particle;
using testing::ellipsoid;
using testing::identical;

constexpr double h = 0.1, dt = 0.01;
const std::vector<Material> materials{{"sand", 2500.0, 0.6, 0.5}, {"gravel", 2500.0, 0.6, 0.7}};
const double full = 1500.0 * h * h * h;
const Grid grid{Vector3d::Zero(), h, {6, 5, 4}, {false, false, false}};
const Vector3d centre(0.25, 0.25, 0.25);  // of a cell

bool everywhere(const Vector3d&, const Vector3d&) { return true; }

ReshapeRules no_floor() {
  ReshapeRules rules;
  rules.fewest_in_cell = 0;
  return rules;
}

/// Two light particles side by side, `gap` apart about a cell's centre, which merge if nothing is changed.
Particles pair(const Vector3d& gap = {0.0, 0.02, 0.0}) {
  Particles particles;
  add_particle(centre - gap / 2.0, full / 32.0, ellipsoid(0.03, 0.02, 0.02), particles);
  add_particle(centre + gap / 2.0, full / 32.0, ellipsoid(0.03, 0.02, 0.02), particles);
  return particles;
}

/// A cell's worth of disordered sand in each of 2 x 2 x 2 cells, of both materials, with every kind of shape.
Particles disordered(int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.1, 0.3);
  Particles particles;
  for (int p = 0; p < count; ++p) {
    Matrix3d axes;
    for (double& v : axes.reshaped()) v = 0.3 * h * normal(random);
    const Vector3d position(uniform(random), uniform(random), uniform(random));
    add_particle(position, full / 25.0 * uniform(random) / 0.2,
                 axes * axes.transpose() + ellipsoid(0.005, 0.005, 0.005), particles);
    for (double& v : particles.velocities.col(p)) v = 0.1 * normal(random);
    particles.materials.back() = p % 3 == 0;
  }
  return particles;
}

TEST(Split, HalvesTheLongestSemiAxisUntilNoneIsTooLong) {
  Particles particles;
  add_particle(centre, full / 8.0, ellipsoid(0.02, 0.16, 0.02), particles);
  particles.velocities.col(0) = Vector3d(1.0, 2.0, 3.0);
  const SplitReport report = split(grid, materials, everywhere, {}, particles);
  EXPECT_EQ(report.splits, 3);
  ASSERT_EQ(particles.count(), 4);
  for (Eigen::Index p = 0; p < 4; ++p) {
    EXPECT_NEAR(particles.masses[p], full / 32.0, 1e-15);
    EXPECT_LT((shape_matrix(particles, p) - ellipsoid(0.02, 0.04, 0.02)).norm(), 1e-15);
    EXPECT_EQ(particles.velocities.col(p), Vector3d(1.0, 2.0, 3.0));
    EXPECT_EQ(particles.positions(0, p), centre[0]);
  }
  EXPECT_EQ(report.put_off + report.too_light + report.unfinished, 0);
}

TEST(Split, BeginsAtTheThresholdOfTheRules) {
  for (const double share : {0.999, 1.001}) {
    Particles particles;
    add_particle(centre, full / 8.0, ellipsoid(0.02, 0.02, 0.75 * h * share), particles);
    EXPECT_EQ(split(grid, materials, everywhere, {}, particles).splits, share > 1.0);
  }
}

TEST(Split, SpreadingCloudThatFillsACellDoesNotSplit) {
  Particles particles;
  add_particle(centre, full / 8.0, ellipsoid(0.05, 0.0495, 0.05), particles);
  for (int step = 0; step < 50; ++step) {
    deform((10.0 * Matrix3d::Identity()).reshaped(), dt, materials, h, particles);
    ASSERT_EQ(split(grid, materials, everywhere, {}, particles).splits, 0);
  }
  EXPECT_NEAR(shape_volume(shape_matrix(particles, 0)), h * h * h, 1e-9 * h * h * h);
}

TEST(Split, IsPutOffWhereAChildWouldLeaveTheDomainOrEnterAWall) {
  Particles particles;
  add_particle({0.02, 0.25, 0.25}, full / 8.0, ellipsoid(0.1, 0.02, 0.02), particles);  // left side
  add_particle({0.45, 0.25, 0.25}, full / 8.0, ellipsoid(0.1, 0.02, 0.02), particles);  // beside the wall
  add_particle({0.25, 0.25, 0.25}, full / 8.0, ellipsoid(0.1, 0.02, 0.02), particles);  // in the open
  const Particles before = particles;
  const auto left_of_wall = [](const Vector3d&, const Vector3d& x) { return x[0] < 0.48; };
  const SplitReport report = split(grid, materials, left_of_wall, {}, particles);
  EXPECT_EQ(report.put_off, 2);
  EXPECT_EQ(report.splits, 1);
  ASSERT_EQ(particles.count(), 4);
  EXPECT_EQ(particles.positions.leftCols(2), before.positions.leftCols(2));
  EXPECT_EQ(particles.shapes.leftCols(2), before.shapes.leftCols(2));
  EXPECT_EQ(particles.masses[1], before.masses[1]);
}

TEST(Split, FirstChildLiesUpTheAxisWhateverSignTheEigenvectorHas) {
  for (int degrees = 0; degrees < 360; degrees += 7) {
    const Matrix3d turn =
        Eigen::AngleAxisd(degrees * std::numbers::pi / 180.0, Vector3d(1.0, 2.0, 3.0).normalized())
            .toRotationMatrix();
    Particles particles;
    add_particle(centre, full / 8.0, turn * ellipsoid(0.1, 0.02, 0.02) * turn.transpose(), particles);
    ASSERT_EQ(split(grid, materials, everywhere, {}, particles).splits, 1);
    const Vector3d offset = particles.positions.col(0) - centre;
    EXPECT_GT(offset.maxCoeff(), -offset.minCoeff()) << degrees;
    EXPECT_LT((particles.positions.col(1) - centre + offset).norm(), 1e-15);
  }
}

TEST(Split, WrapsAroundPeriodicAxes) {
  Grid ring = grid;
  ring.periodic[0] = true;
  Particles particles;
  add_particle({0.02, 0.25, 0.25}, full / 8.0, ellipsoid(0.1, 0.02, 0.02), particles);
  EXPECT_EQ(split(ring, materials, everywhere, {}, particles).splits, 1);
  const double d = std::sqrt(0.15) * 0.1;
  EXPECT_NEAR(particles.positions(0, 0), 0.02 + d, 1e-15);
  EXPECT_NEAR(particles.positions(0, 1), 0.62 - d, 1e-15);
}

TEST(Split, LightOnesStayLongAndAreCounted) {
  Particles particles;
  const Grid tall{Vector3d(0.0, 0.0, -1.0), h, {5, 5, 30}, {false, false, false}};
  add_particle(centre, full / 16.0, ellipsoid(0.02, 0.02, 0.35), particles);
  const SplitReport report = split(tall, materials, everywhere, {}, particles);
  EXPECT_EQ(report.splits, 3);  // to four of full / 64
  EXPECT_EQ(report.too_light, 4);
}

TEST(Split, EndsAfterItsRoundsAndSaysHowManyAreLeft) {
  ReshapeRules rules;
  rules.smallest_split_mass = 0.0;
  const Grid vast{Vector3d::Constant(-1e5), 1e3, {200, 200, 200}, {false, false, false}};
  Particles particles;
  add_particle(Vector3d::Zero(), 1.0, ellipsoid(1e-3, 1e-3, 1e3), particles);
  rules.split_semi_axis = 1e-6;
  const SplitReport report = split(vast, materials, everywhere, rules, particles);
  EXPECT_EQ(particles.count(), 1 << most_split_rounds);
  EXPECT_EQ(report.unfinished, 1 << most_split_rounds);
}

TEST(Split, ShapeThatIsNotFiniteIsLeftAlone) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Particles particles = pair();
    particles.shapes.setConstant(bad);
    const ReshapeReport report = split_and_merge(grid, materials, everywhere, no_floor(), dt, particles);
    EXPECT_EQ(report.split.splits + report.merge.merges, 0);
    EXPECT_EQ(particles.count(), 2);
  }
}

TEST(Merge, TwoCloseSmallParticlesBecomeTheirUnion) {
  Particles particles = pair();
  particles.masses[1] *= 2.0;
  particles.velocities.col(1) = Vector3d(0.1, 0.0, 0.0);
  const double m = particles.masses.sum();
  const MergeReport report = merge(grid, materials, everywhere, no_floor(), dt, particles);
  EXPECT_EQ(report.merges, 1);
  ASSERT_EQ(particles.count(), 1);
  EXPECT_EQ(particles.masses[0], m);
  EXPECT_LT((particles.positions.col(0) - centre - Vector3d(0.0, 0.02 / 6.0, 0.0)).norm(), 1e-15);
  EXPECT_LT((particles.velocities.col(0) - Vector3d(0.2 / 3.0, 0.0, 0.0)).norm(), 1e-15);
  Matrix3d expected = ellipsoid(0.03, 0.02, 0.02);
  expected(1, 1) += 5.0 * 2.0 / 9.0 * 0.02 * 0.02;
  EXPECT_LT((shape_matrix(particles, 0) - expected).norm(), 1e-15);
  EXPECT_EQ(particles.gradients.norm(), 0.0);
  EXPECT_NEAR(report.energy_lost, 0.5 * m * 2.0 / 9.0 * 0.01, 1e-15 * m);
}

TEST(Merge, EachConditionAloneKeepsAPairApart) {
  const auto merges = [](Particles particles, const ReshapeRules& rules = no_floor(),
                         const Allowed& allowed = everywhere) {
    const Particles before = particles;
    const Eigen::Index count = merge(grid, materials, allowed, rules, dt, particles).merges;
    EXPECT_EQ(identical(particles, before), count == 0);
    return count;
  };
  EXPECT_EQ(merges(pair()), 1);

  Particles other = pair();
  other.materials[1] = 1;
  EXPECT_EQ(merges(other), 0) << "materials differ";
  other.materials[0] = 1;
  EXPECT_EQ(merges(other), 1) << "the same material again";

  EXPECT_EQ(merges(pair({0.045, 0.0, 0.0})), 0) << "too long a union";
  EXPECT_EQ(merges(pair({0.0, 0.045, 0.0})), 1) << "the same distance side by side";
  Particles thin = pair({0.0, 0.051, 0.0});
  thin.masses[0] /= 100.0;  // its union is hardly longer than the heavy one
  EXPECT_EQ(merges(thin), 0) << "too far apart";
  thin.positions.col(0) += Vector3d(0.0, 0.002, 0.0);
  EXPECT_EQ(merges(thin), 1) << "just near enough";

  Particles heavy = pair();
  heavy.masses[1] = full * 0.1;
  EXPECT_EQ(merges(heavy), 0) << "heavier than an eighth of a full cell";

  Particles fast = pair();
  fast.velocities(2, 0) = 0.05 * h / dt * 1.01;
  EXPECT_EQ(merges(fast), 0) << "relative speed";
  fast.velocities.row(2).array() += 100.0;
  EXPECT_EQ(merges(fast), 0) << "relative speed";
  fast.velocities(2, 0) = fast.velocities(2, 1) + 0.05 * h / dt * 0.99;
  EXPECT_EQ(merges(fast), 1) << "only the relative speed counts";

  Particles apart = pair();
  apart.positions.row(1).array() += 0.05;  // the face y = 0.3 is between them
  EXPECT_EQ(merges(apart), 0) << "different cells";
  Particles outside = pair();
  outside.positions.row(0).array() -= 1.0;
  EXPECT_EQ(merges(outside), 0) << "outside the domain";

  EXPECT_EQ(merges(pair(), no_floor(),
                   [](const Vector3d&, const Vector3d& x) { return (x - centre).norm() > 1e-3; }),
            0)
      << "their centre is in a wall";
  for (const Eigen::Index shut_in : {0, 1}) {
    const Vector3d place = pair().positions.col(shut_in);
    EXPECT_EQ(
        merges(pair(), no_floor(), [&](const Vector3d& from, const Vector3d&) { return from != place; }), 0)
        << "a wall is between them";
  }
}

TEST(Merge, CellWithEightParticlesMergesNone) {
  Particles particles;
  for (int p = 0; p < 12; ++p)
    add_particle(centre + Vector3d(0.0, 0.001 * p, 0.0), full / 64.0, ellipsoid(0.02, 0.02, 0.02), particles);
  Particles eight = particles;
  eight.resize(8);
  const Particles before = eight;
  EXPECT_EQ(merge(grid, materials, everywhere, {}, dt, eight).merges, 0);
  EXPECT_TRUE(identical(eight, before));
  EXPECT_EQ(merge(grid, materials, everywhere, {}, dt, particles).merges, 4);
  EXPECT_EQ(particles.count(), 8);
}

TEST(Merge, EachParticleMergesOnceInACall) {
  Particles particles;
  for (int p = 0; p < 9; ++p)
    add_particle(centre + Vector3d(0.0, 0.001 * p, 0.0), full / 128.0, ellipsoid(0.02, 0.02, 0.02),
                 particles);
  EXPECT_EQ(merge(grid, materials, everywhere, no_floor(), dt, particles).merges, 4);
  ASSERT_EQ(particles.count(), 5);
  EXPECT_EQ((particles.masses > full / 100.0).count(), 4);
}

TEST(Merge, TakesTheNearestWhereverItStandsInTheOrder) {
  for (const Eigen::Index nearest : {1, 2, 3}) {
    Particles particles;
    for (Eigen::Index p = 0; p < 4; ++p) {
      const double offset = p == 0 ? 0.0 : p == nearest ? 0.01 : 0.02 + 0.001 * static_cast<double>(p);
      add_particle(centre + Vector3d(0.0, offset, 0.0), full / 32.0, ellipsoid(0.02, 0.02, 0.02), particles);
    }
    merge(grid, materials, everywhere, no_floor(), dt, particles);
    ASSERT_EQ(particles.count(), 2);
    EXPECT_NEAR(particles.positions(1, 0), centre[1] + 0.005, 1e-15) << nearest;
  }
}

TEST(Merge, KeepsTheSpinOfAPairThatCarriesGradients) {
  Particles particles = pair();
  particles.velocities.col(0) = Vector3d(0.05, 0.0, 0.0);
  particles.velocities.col(1) = Vector3d(-0.05, 0.0, 0.0);
  Particles flip = particles;
  const testing::Sums before = testing::sums_of(particles);
  particles.gradients(3, 0) = 1e-3;
  const testing::Sums with_gradient = testing::sums_of(particles);
  const MergeReport report = merge(grid, materials, everywhere, no_floor(), dt, particles);
  const testing::Sums after = testing::sums_of(particles);
  EXPECT_LT(testing::relative_difference(with_gradient, after), 1e-13);
  EXPECT_NEAR(report.energy_lost, with_gradient.energy - after.energy, 1e-12 * before.energy);
  EXPECT_GT(report.energy_lost, 0.0);
  EXPECT_LT(report.energy_lost, 0.7 * before.energy);
  // FLIP has nowhere to keep it, whether it stores zeros or nothing.
  Particles bare = flip;
  bare.gradients.resize(9, 0);
  EXPECT_NEAR(merge(grid, materials, everywhere, no_floor(), dt, flip).energy_lost, before.energy,
              1e-12 * before.energy);
  EXPECT_NEAR(merge(grid, materials, everywhere, no_floor(), dt, bare).energy_lost, before.energy,
              1e-12 * before.energy);
  EXPECT_FALSE(bare.has_gradients());
  EXPECT_EQ(bare.shapes, flip.shapes);
}

TEST(Reshape, HalvesDoNotMergeAgain) {
  Particles particles;
  add_particle(centre, full / 32.0, ellipsoid(0.01, 0.76 * h, 0.01), particles);
  EXPECT_EQ(split_and_merge(grid, materials, everywhere, no_floor(), dt, particles).split.splits, 1);
  ASSERT_EQ(particles.count(), 2);
  // In one cell, so that only their length keeps them apart.
  ASSERT_EQ(grid.cell_at(particles.positions.col(0)), grid.cell_at(particles.positions.col(1)));
  const Particles before = particles;
  for (int call = 0; call < 3; ++call)
    split_and_merge(grid, materials, everywhere, no_floor(), dt, particles);
  EXPECT_TRUE(identical(particles, before));
}

TEST(Reshape, MergedOnesDoNotSplitAgainEvenAfterTheyHaveRoomForTheirMass) {
  // Wholly overlapping, at the packing limit and as long as a union may be: deform doubles the volume.
  const double a = 0.55 * h * 0.9999, volume = h * h * h / 16.0;
  const double b = std::sqrt(volume / (4.0 / 3.0 * std::numbers::pi * a));
  Particles particles;
  for (int p = 0; p < 2; ++p) add_particle(centre, full / 16.0, ellipsoid(a, b, b), particles);
  EXPECT_EQ(merge(grid, materials, everywhere, no_floor(), dt, particles).merges, 1);
  const DeformReport room =
      deform(Eigen::Matrix<double, 9, Eigen::Dynamic>::Zero(9, 1), dt, materials, h, particles);
  EXPECT_EQ(room.enlarged, 1);
  EXPECT_NEAR(std::sqrt(particles.shapes(0, 0)), a * std::cbrt(2.0), 1e-12);
  EXPECT_EQ(split(grid, materials, everywhere, {}, particles).splits, 0);
}

TEST(Reshape, NothingChangesWhereNothingQualifies) {
  Particles particles;  // the lattice of a new scene
  const double radius = std::cbrt(0.75 / std::numbers::pi / 8.0) * h;
  for (int k = 0; k < 8; ++k)
    for (int j = 0; j < 10; ++j)
      for (int i = 0; i < 12; ++i)
        add_particle((Vector3d(i, j, k) + Vector3d::Constant(0.5)) * h / 2.0, full / 8.0,
                     ellipsoid(radius, radius, radius), particles);
  const Particles before = particles;
  const ReshapeReport report = split_and_merge(grid, materials, everywhere, {}, dt, particles);
  EXPECT_EQ(report.split.splits + report.merge.merges, 0);
  EXPECT_TRUE(identical(particles, before));
  Particles none;
  split_and_merge(grid, materials, everywhere, {}, dt, none);
  EXPECT_EQ(none.count(), 0);
}

TEST(Reshape, SettlesAndDependsOnNothingButItsInput) {
  Particles first = disordered(400, 5), second = first;
  const ReshapeReport once = split_and_merge(grid, materials, everywhere, {}, dt, first);
  const ReshapeReport twice = split_and_merge(grid, materials, everywhere, {}, dt, second);
  EXPECT_GT(once.split.splits, 10);
  EXPECT_GT(once.merge.merges, 50);
  EXPECT_TRUE(identical(first, second));
  EXPECT_EQ(once.merge.energy_lost, twice.merge.energy_lost);
  ReshapeReport report = once;
  for (int call = 0; call < 20 && report.split.splits + report.merge.merges > 0; ++call)
    report = split_and_merge(grid, materials, everywhere, {}, dt, first);
  EXPECT_EQ(report.split.splits + report.merge.merges, 0);
}

TEST(Reshape, SteadyShearKeepsTheNumberOfParticlesBounded) {
  // Uniform shear of a periodic block, 60 strains: without merging 8 a cell become the 64 that too_light allows.
  const Grid block{Vector3d::Zero(), h, {4, 4, 4}, {true, true, true}};
  const double radius = std::cbrt(0.75 / std::numbers::pi / 8.0) * h;
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(0.0, 4.0 * h);
  Particles particles;
  for (int p = 0; p < 8 * 64; ++p)
    add_particle({uniform(random), uniform(random), uniform(random)}, full / 8.0,
                 ellipsoid(radius, radius, radius), particles);
  Matrix3d gradient = Matrix3d::Zero();
  gradient(0, 2) = 1.0;
  const double mass = particles.masses.sum();
  Eigen::Index splits = 0, merges = 0, most = 0;
  for (int step = 0; step < 600; ++step) {
    // A sheared ring is not periodic in z: each particle's own height gives its speed, and it never leaves its row.
    for (Eigen::Index p = 0; p < particles.count(); ++p) {
      particles.velocities.col(p) = gradient * particles.positions.col(p);
      particles.positions.col(p) =
          block.wrapped_position(particles.positions.col(p) + 0.1 * particles.velocities.col(p));
    }
    const Eigen::Matrix<double, 9, Eigen::Dynamic> gradients =
        gradient.reshaped().replicate(1, particles.count());
    deform(gradients, 0.1, materials, h, particles);
    const ReshapeReport report = split_and_merge(block, materials, everywhere, {}, 0.1, particles);
    splits += report.split.splits;
    merges += report.merge.merges;
    most = std::max(most, particles.count());
  }
  RecordProperty("most_per_cell", static_cast<int>(most / 64));
  EXPECT_GT(splits, 512);
  EXPECT_GT(merges, 512);
  EXPECT_LT(most, 16 * 64);
  EXPECT_GE(particles.count(), 8 * 64 * 9 / 10);
  EXPECT_NEAR(particles.masses.sum(), mass, 1e-12 * mass);
}

}  // namespace
}  // namespace talus
