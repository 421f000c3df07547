// Whose render points are when particles sort, split, merge, leave, are buried and come to light.
#include <gtest/gtest.h>

#include <random>

#include "continuum/particles/move.h"
#include "continuum/particles/reshape.h"
#include "continuum/particles/sort.h"
#include "tests/continuum/particles/render_point_specimens.h"

namespace talus {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace)

/// A particle that splits in two: each of its points stays where it is, with the half that holds it best.
void expect_halves_share_points(const Grid& in, const Vector3d& centre) {
  const Surroundings around{in, open_sides, no_openings, nullptr, {}};
  Particles particles = one_particle(centre, oblique(0.5, 0.2, 0.15), 0.02);
  RenderPoints drawn = sampled(particles, 1000, around);
  ASSERT_EQ(drawn.count(), 2000);
  const auto before = by_identity(particles, drawn, in);
  const HandOverReport report = hand_over_after(
      around, [&](Particles& all) { ASSERT_EQ(split(in, materials, everywhere, {}, all).splits, 1); },
      particles, drawn);
  EXPECT_EQ(report.resampled, 0);
  EXPECT_EQ(report.added + report.hidden + report.departed, 0);
  ASSERT_EQ(drawn.first, (std::vector<std::int64_t>{0, drawn.first[1], 2000}));
  EXPECT_NEAR(static_cast<double>(drawn.first[1]), 1000.0, 4.0 * std::sqrt(500.0));
  const auto after = by_identity(particles, drawn, in);
  ASSERT_EQ(after.size(), before.size());
  for (const auto& [identity, place] : after)
    EXPECT_LT(short_way(in, before.at(identity), place).norm(), 1e-6);
  const auto distance_in = [&](Eigen::Index p, const Vector3d& place) {
    const Parent half(around, particles, p);
    return std::sqrt(half.squared_distance(short_way(in, half.centre(), place)));
  };
  for (Eigen::Index p = 0; p < 2; ++p) {
    for (auto k = drawn.first[static_cast<std::size_t>(p)]; k < drawn.first[static_cast<std::size_t>(p) + 1];
         ++k) {
      const Vector3d place = after.at(drawn.identities[static_cast<std::size_t>(k)]);
      EXPECT_LE(distance_in(p, place), distance_in(1 - p, place) + 1e-5);
      EXPECT_LE(distance_in(p, place), std::sqrt(1.6) + 1e-5);
    }
  }
}

TEST(RenderPointHandOver, GoToTheHalfThatHoldsThemBest) { expect_halves_share_points(grid, {2.0, 2.0, 2.0}); }

TEST(RenderPointHandOver, GoToTheHalfThatHoldsThemBestAcrossSeams) {
  Grid ring = grid;
  ring.periodic = {true, true, true};
  expect_halves_share_points(ring, {0.05, 2.0, 2.0});
  expect_halves_share_points(ring, {3.95, 0.02, 3.98});
}

TEST(RenderPointHandOver, OfBothGoToWhatAMergeMakes) {
  Particles particles = one_particle({2.1, 2.1, 2.1}, testing::ellipsoid(0.12, 0.1, 0.1), 0.004);
  testing::add_particle({2.2, 2.1, 2.1}, 0.004 * full, testing::ellipsoid(0.1, 0.12, 0.1), particles);
  testing::add_particle({0.2, 0.1, 0.1}, 0.004 * full, testing::ellipsoid(0.1, 0.1, 0.1), particles);
  RenderPoints drawn = sampled(particles, 250);
  ASSERT_EQ(drawn.count(), 300);
  const auto before = by_identity(particles, drawn);
  ReshapeRules rules;
  rules.fewest_in_cell = 1;
  const HandOverReport report = hand_over_after(
      nowhere,
      [&](Particles& all) { ASSERT_EQ(merge(grid, materials, everywhere, rules, dt, all).merges, 1); },
      particles, drawn);
  EXPECT_EQ(report.added + report.hidden + report.departed, 0);
  ASSERT_EQ(drawn.first, (std::vector<std::int64_t>{0, 200, 300}));
  const auto after = by_identity(particles, drawn);
  std::int64_t moved = 0;
  for (const auto& [identity, place] : after) moved += (place - before.at(identity)).norm() > 1e-6;
  EXPECT_EQ(moved, report.resampled);
  EXPECT_LT(moved, 20);  // the union is about the hull of the two
}

TEST(RenderPointHandOver, SplitAndMergeOfOneStepKeepThemAll) {
  // The halves of the middle particle merge with their neighbours.
  Particles particles = one_particle({2.25, 2.25, 2.25}, testing::ellipsoid(0.4, 0.1, 0.1), 0.008);
  for (const double x : {2.05, 2.45})
    testing::add_particle({x, 2.2, 2.25}, 0.004 * full, testing::ellipsoid(0.1, 0.1, 0.1), particles);
  RenderPoints drawn = sampled(particles, 250);
  ASSERT_EQ(drawn.count(), 400);
  const auto before = by_identity(particles, drawn);
  ReshapeRules rules;
  rules.fewest_in_cell = 1;
  rules.merge_semi_axis = 0.7;
  hand_over_after(
      nowhere,
      [&](Particles& all) {
        const ReshapeReport report = split_and_merge(grid, materials, everywhere, rules, dt, all);
        ASSERT_EQ(report.split.splits, 1);
        ASSERT_EQ(report.merge.merges, 2);
      },
      particles, drawn);
  ASSERT_EQ(particles.count(), 2);
  ASSERT_EQ(drawn.count(), 400);
  const auto after = by_identity(particles, drawn);
  ASSERT_EQ(after.size(), 400u);
  for (const auto& [identity, place] : after) EXPECT_TRUE(before.contains(identity));
  EXPECT_NEAR(static_cast<double>(drawn.first[1]), 200.0, 4.0 * std::sqrt(50.0));
}

TEST(RenderPointHandOver, OfHalvesThatMergeAgainAreNotDoubled) {
  Particles particles = one_particle({2.25, 2.25, 2.25}, oblique(0.4, 0.1, 0.1), 0.008);
  RenderPoints drawn = sampled(particles, 250);
  ASSERT_EQ(drawn.count(), 200);
  const auto before = by_identity(particles, drawn);
  ReshapeRules rules;
  rules.fewest_in_cell = 1;
  rules.merge_semi_axis = 1.1 * rules.split_semi_axis;
  rules.merge_distance = 1.0;
  const HandOverReport report = hand_over_after(
      nowhere,
      [&](Particles& all) {
        const ReshapeReport reshaped = split_and_merge(grid, materials, everywhere, rules, dt, all);
        ASSERT_EQ(reshaped.split.splits, 1);
        ASSERT_EQ(reshaped.merge.merges, 1);
      },
      particles, drawn);
  ASSERT_EQ(particles.count(), 1);
  EXPECT_EQ(report.added + report.hidden + report.resampled + report.departed, 0);
  ASSERT_EQ(drawn.count(), 200);
  for (const auto& [identity, place] : by_identity(particles, drawn))
    EXPECT_LT((place - before.at(identity)).norm(), 1e-6);
}

TEST(RenderPointHandOver, ThatLeaveTheirParentAreSampledAnew) {
  const Matrix3d shape = oblique(0.3, 0.2, 0.1);
  Particles particles = one_particle({2.0, 2.0, 2.0}, shape);
  RenderPoints drawn = sampled(particles, 3);
  const Matrix3d map = map_of_ball(shape);
  const Vector3d direction = Vector3d(1.0, -2.0, 0.7).normalized();
  drawn.offsets[0] = (0.999 * farthest_offset * map * direction).cast<float>();
  drawn.offsets[1] = (1.001 * farthest_offset * map * direction).cast<float>();
  drawn.offsets[2].setConstant(std::numeric_limits<float>::quiet_NaN());
  const Eigen::Vector3f kept = drawn.offsets[0];
  const HandOverReport report = hand_over_after(
      nowhere, [](Particles&) {}, particles, drawn);
  EXPECT_EQ(report.resampled, 2);
  EXPECT_EQ(drawn.offsets[0], kept);
  EXPECT_EQ(drawn.identities, (std::vector<std::uint32_t>{0, 1, 2}));
  for (const std::size_t k : {1u, 2u})
    EXPECT_LE(Parent(nowhere, particles, 0).squared_distance(drawn.offsets[k].cast<double>()), 1.0 + 1e-5);
  EXPECT_NE(drawn.offsets[1], drawn.offsets[2]);
}

TEST(RenderPointHandOver, FollowTheirParticlesThroughSortingRemovalAndSeams) {
  Grid ring = grid;
  ring.periodic[0] = true;
  const Surroundings around{ring, open_sides, no_openings, nullptr, {}};
  Particles particles;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int p = 0; p < 500; ++p)
    testing::add_particle({4.0 * unit(random), 4.0 * unit(random), 4.0 * unit(random)}, 0.01 * full,
                          testing::ellipsoid(0.1 + 0.1 * unit(random), 0.1, 0.1), particles);
  RenderPoints drawn = sampled(particles, 6, around);
  const auto before = by_identity(particles, drawn, ring);
  const Vector3d shift(0.3, 0.0, 0.05);
  const Eigen::Index stay = (particles.positions.row(2).array() < 4.0 - shift[2]).count();
  Eigen::Matrix3Xd centres;
  particles.track_origins();
  particles.positions.colwise() += shift;
  wrap_positions(ring, particles.positions);
  centres = particles.positions;
  EXPECT_EQ(remove_departed(ring, particles).count, 500 - stay);
  PointsByCell cells = points_by_cell(ring, particles.positions);
  sort_by_cell(cells, particles);
  const HandOverReport report = hand_over(around, materials, centres, particles, drawn);
  EXPECT_EQ(report.departed, 6 * (500 - stay));
  EXPECT_EQ(report.resampled, 0);
  ASSERT_EQ(drawn.count(), 6 * stay);
  for (std::size_t p = 0; p < static_cast<std::size_t>(stay); ++p) EXPECT_EQ(points_of(drawn, p), 6);
  for (const auto& [identity, place] : by_identity(particles, drawn, ring))
    EXPECT_LT(short_way(ring, before.at(identity) + shift, place).norm(), 1e-6);
}

/// After a hand-over with the block's fill.
HandOverReport look_at(Block& block, RenderPoints& drawn) {
  const std::vector<Cover> cover = cover_of_cells(block.region, block.fill);
  return hand_over_after(
      {grid, open_sides, no_openings, &block.region, cover}, [](Particles&) {}, block.particles, drawn);
}

TEST(RenderPointHandOver, AreNotKeptWhereTheyAreBuriedAndComeBackWhenTheSurfaceOpens) {
  constexpr int each = 5;
  Block block;
  RenderPoints drawn = sampled(block.particles, each * 0.01 / (0.125 * h * h * h));
  ASSERT_EQ(drawn.count(), each * block.particles.count());
  EXPECT_EQ(look_at(block, drawn).hidden, each * 8 * 64);  // cells 2 to 5 of 1 to 6
  EXPECT_EQ(drawn.count(), each * 8 * (216 - 64));
  EXPECT_EQ(block.shown(drawn, 2, 3, 3), 0);
  EXPECT_EQ(block.shown(drawn, 1, 3, 3), 8);
  // The noise of a fill changes nothing; less does.
  block.fill[block.cell(1, 3, 3)] = 0.5 * (open_fill + buried_fill);
  HandOverReport report = look_at(block, drawn);
  EXPECT_EQ(report.added + report.hidden, 0);
  block.fill[block.cell(1, 3, 3)] = 0.9 * open_fill;
  report = look_at(block, drawn);
  EXPECT_EQ(report.added, each * 8 * 9);  // the cells beside it, corners too
  EXPECT_EQ(report.hidden, 0);
  EXPECT_EQ(block.shown(drawn, 2, 4, 2), 8);
  EXPECT_EQ(block.shown(drawn, 3, 3, 3), 0);
  block.fill[block.cell(1, 3, 3)] = 0.5 * (open_fill + buried_fill);
  report = look_at(block, drawn);
  EXPECT_EQ(report.added + report.hidden, 0);
  block.fill[block.cell(1, 3, 3)] = buried_fill;
  EXPECT_EQ(look_at(block, drawn).hidden, each * 8 * 9);
  // And when what covers them is gone.
  Particles& all = block.particles;
  report = hand_over_after(
      nowhere,
      [](Particles& sand) {
        for (Eigen::Index p = 0; p < sand.count(); ++p)
          if (sand.positions(2, p) > 4.0 * h) sand.positions(2, p) = -1.0;
        remove_departed(grid, sand);
      },
      all, drawn);
  block.look();
  EXPECT_EQ(drawn.count(), each * all.count());
  EXPECT_EQ(look_at(block, drawn).hidden, each * 8 * 16);
  for (std::size_t p = 0; p < static_cast<std::size_t>(all.count()); ++p)
    EXPECT_TRUE(points_of(drawn, p) == each || (points_of(drawn, p) == 0 && drawn.hidden[p] != 0));
}

TEST(RenderPointHandOver, AlongTheEndsOfTheDomainAreAlwaysKept) {
  Grid ring = grid;
  ring.periodic = {true, true, true};
  Eigen::Matrix3Xd centres(3, ring.cells.prod());
  for (int cell = 0; cell < ring.cells.prod(); ++cell)
    centres.col(cell) = h * (ring.cell_of_index(cell).cast<double>().array() + 0.5);
  const ActiveRegion region = make_active_region(ring, open_sides, centres);
  const std::vector<Cover> cover = cover_of_cells(region, Field::Constant(region.cell_count() + 1, 1.0));
  for (int cell = 0; cell < region.cell_count(); ++cell) {
    const Eigen::Vector3i place = ring.cell_of_index(region.dense_of_cell[static_cast<std::size_t>(cell)]);
    const bool at_end = (place.array() == 0).any() || (place.array() == 7).any();
    EXPECT_EQ(cover[static_cast<std::size_t>(cell)], at_end ? Cover::open : Cover::buried);
  }
}

TEST(RenderPointHandOver, OfAMergeThatWasPartlyBuriedAreMadeUpWhenItIsOpen) {
  Particles particles = one_particle({2.1, 2.1, 2.1}, testing::ellipsoid(0.1, 0.1, 0.1), 0.004);
  testing::add_particle({2.15, 2.1, 2.1}, 0.004 * full, testing::ellipsoid(0.1, 0.1, 0.1), particles);
  RenderPoints drawn = sampled(particles, 250);
  drawn.offsets.resize(100);
  drawn.identities.resize(100);
  drawn.first = {0, 100, 100};
  drawn.hidden = {0, 1};
  const auto before = by_identity(particles, drawn);
  ReshapeRules rules;
  rules.fewest_in_cell = 1;
  hand_over_after(
      nowhere, [&](Particles& all) { merge(grid, materials, everywhere, rules, dt, all); }, particles, drawn);
  ASSERT_EQ(particles.count(), 1);
  EXPECT_EQ(drawn.count(), 200);
  const auto after = by_identity(particles, drawn);
  for (const auto& [identity, place] : before) EXPECT_TRUE(after.contains(identity));
  EXPECT_EQ(drawn.hidden[0], 0);
}

TEST(RenderPointHandOver, OfOtherParticlesAreRefused) {
  Particles particles = one_particle({2.0, 2.0, 2.0}, testing::ellipsoid(0.2, 0.2, 0.2));
  RenderPoints drawn = sampled(particles, 3);
  EXPECT_THROW(hand_over(nowhere, materials, Eigen::Matrix3Xd(3, 2), particles, drawn),
               std::invalid_argument);
  testing::add_particle({2.0, 2.0, 2.0}, 1.0, testing::ellipsoid(0.2, 0.2, 0.2), particles);
  particles.track_origins();
  EXPECT_THROW(hand_over(nowhere, materials, Eigen::Matrix3Xd(3, 1), particles, drawn),
               std::invalid_argument);
}

}  // namespace
}  // namespace talus
