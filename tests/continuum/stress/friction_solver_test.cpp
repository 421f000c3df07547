// The friction solver on rows against the plain one (qp/cone_projection.h) on the plain operator.
#include "continuum/stress/friction_solver.h"

#include <gtest/gtest.h>

#include "continuum/parallel.h"
#include "tests/continuum/grid/ragged_region.h"

namespace talus {
namespace {

/// A friction problem with everything in it drawn at random.
struct Drawn {
  Field inverse_mass, free_velocity;  // of open faces and the null face
  BallBlocks balls;
  Eigen::ArrayXd start;
};

Drawn draw(const ActiveRegion& region, std::mt19937_64& random) {
  const FrictionOperator friction(region);
  const Eigen::Index faces = region.open_faces + 1;
  Drawn drawn{
      (0.5 * testing::random_field(faces, random)).exp(), testing::random_field(faces, random), {}, {}};
  drawn.inverse_mass[region.null_face()] = drawn.free_velocity[region.null_face()] = 0.0;
  drawn.balls = friction.blocks(drawn.inverse_mass);
  // All copies of a cell have its radius; a few cells have none.
  const Eigen::Index cells = region.cell_count();
  const Field radii = (testing::random_field(cells, random) + 0.8).max(0.0);
  for (Eigen::Index cell = 0; cell < cells; ++cell)
    drawn.balls.radius.segment(copies_per_cell * cell, copies_per_cell) = radii[cell];
  const Eigen::Index tractions = drawn.balls.count[1];
  drawn.balls.radius.tail(tractions) = (testing::random_field(tractions, random) + 0.8).max(0.0);
  drawn.start = testing::random_field(drawn.balls.values(), random);
  friction.clear_idle(drawn.start);
  return drawn;
}

struct Solved {
  ConeProjectionResult result;
  Eigen::ArrayXd copies;
  double lipschitz = 1.0;
};

Solved solve_plainly(const ActiveRegion& region, const Drawn& drawn, const ConeProjectionSettings& settings) {
  const FrictionOperator friction(region);
  Solved solved{{}, drawn.start};
  Field mass = (drawn.inverse_mass > 0.0).select(drawn.inverse_mass.max(1e-300).inverse(), 0.0);
  Field velocity(mass.size());
  solved.result = project_onto_cone(
      [&](const Eigen::ArrayXd& copies, Field& impulse) { friction.apply(copies, impulse); },
      [&](const Field& v, Eigen::ArrayXd& strain) { friction.apply_transpose(v, strain); }, drawn.balls, mass,
      drawn.free_velocity, settings, solved.lipschitz, solved.copies, velocity);
  return solved;
}

Solved solve_on_rows(const ActiveRegion& region, const Drawn& drawn, const ConeProjectionSettings& settings,
                     FrictionSolver solver = {}) {
  Solved solved{{}, drawn.start};
  solver.prepare(region, drawn.inverse_mass);
  solved.result = solver.solve(drawn.balls, drawn.free_velocity, settings, solved.copies);
  solved.lipschitz = solver.lipschitz();
  return solved;
}

double gap_of(const ActiveRegion& region, const Drawn& drawn, const Eigen::ArrayXd& copies) {
  const FrictionOperator friction(region);
  Field impulse(drawn.inverse_mass.size());
  friction.apply(copies, impulse);
  const Field velocity = drawn.free_velocity + drawn.inverse_mass * impulse;
  Eigen::ArrayXd strain(copies.size());
  friction.apply_transpose(velocity, strain);
  return duality_gap(drawn.balls, copies, strain);
}

class FrictionOnRows : public ::testing::TestWithParam<testing::Setting> {
 protected:
  std::mt19937_64 random_{7};
  ActiveRegion region_ = testing::ragged_region(GetParam(), random_);
  Drawn drawn_ = draw(region_, random_);
};

TEST_P(FrictionOnRows, TakesTheSameStepsAsThePlainSolver) {
  for (const int iterations : {0, 1, 7, 40}) {
    const ConeProjectionSettings settings{1e-300, iterations};
    const Solved expected = solve_plainly(region_, drawn_, settings);
    const Solved found = solve_on_rows(region_, drawn_, settings);
    EXPECT_EQ(found.result.iterations, iterations);
    EXPECT_FALSE(found.result.converged);
    EXPECT_LT((found.copies - expected.copies).abs().maxCoeff(), 1e-10) << iterations;
    EXPECT_NEAR(found.result.gap, expected.result.gap, 1e-10 * (1.0 + expected.result.gap)) << iterations;
    EXPECT_NEAR(found.lipschitz, expected.lipschitz, 1e-9) << iterations;
  }
}

TEST_P(FrictionOnRows, ReportsTheGapOfWhatItReturns) {
  const ConeProjectionSettings settings{1e-4, 10000};
  const Solved found = solve_on_rows(region_, drawn_, settings);
  EXPECT_TRUE(found.result.converged);
  EXPECT_LE(found.result.gap, 1e-4);
  EXPECT_NEAR(gap_of(region_, drawn_, found.copies), found.result.gap, 1e-10);
}

TEST_P(FrictionOnRows, SinglePrecisionReachesALooseGap) {
  const double start = gap_of(region_, drawn_, Eigen::ArrayXd::Zero(drawn_.start.size()));
  const ConeProjectionSettings settings{2e-3 * start, 10000};  // loose enough for single precision
  const Solved found = solve_on_rows(region_, drawn_, settings);
  EXPECT_TRUE(found.result.converged);
  EXPECT_LT(gap_of(region_, drawn_, found.copies), 1.01 * settings.gap_tolerance);
  // It was single precision: every value is a float.
  EXPECT_TRUE((found.copies.cast<float>().cast<double>() == found.copies).all());
  // And a tight gap is not left to it.
  const Solved tight = solve_on_rows(region_, drawn_, {1e-6 * start, 10000});
  EXPECT_TRUE(tight.result.converged);
  EXPECT_FALSE((tight.copies.cast<float>().cast<double>() == tight.copies).all());
}

TEST_P(FrictionOnRows, DoesNotDependOnTheNumberOfThreads) {
  const ConeProjectionSettings settings{1e-300, 25};
  const Solved one = solve_on_rows(region_, drawn_, settings);
  set_thread_count(2);
  const Solved two = solve_on_rows(region_, drawn_, settings);
  set_thread_count(1);
  EXPECT_TRUE((one.copies == two.copies).all());
  EXPECT_EQ(one.result.gap, two.result.gap);
}

INSTANTIATE_TEST_SUITE_P(Regions, FrictionOnRows, testing::ragged_settings, testing::name_of_setting);
INSTANTIATE_TEST_SUITE_P(
    MoreRegions, FrictionOnRows,
    ::testing::Values(testing::Setting{"odd_period", {true, true, true}, {5, 3, 4}},
                      testing::Setting{"one_cell_across", {true, false, false}, {1, 6, 5}},
                      testing::Setting{"many_rows", {false, false, false}, {20, 10, 10}}),
    testing::name_of_setting);

TEST(FrictionSolver, KeepsNothingOfAnEarlierProblemButItsStepSize) {
  std::mt19937_64 random(3);
  const ActiveRegion large = testing::ragged_region({"large", {false, false, false}, {9, 8, 7}}, random),
                     small = testing::ragged_region({"small", {false, true, false}, {6, 1, 5}}, random);
  const Drawn drawn_large = draw(large, random), drawn_small = draw(small, random);
  FrictionSolver used;
  used.prepare(large, drawn_large.inverse_mass);
  Eigen::ArrayXd copies = drawn_large.start;
  used.solve(drawn_large.balls, drawn_large.free_velocity, {1e-300, 10}, copies);
  const FrictionSolver fresh = used;  // a copy has the step size alone

  const ConeProjectionSettings settings{1e-300, 20};
  const Solved expected = solve_on_rows(small, drawn_small, settings, fresh);
  Eigen::ArrayXd found = drawn_small.start;
  used.prepare(small, drawn_small.inverse_mass);
  used.solve(drawn_small.balls, drawn_small.free_velocity, settings, found);
  EXPECT_TRUE((found == expected.copies).all());
}

}  // namespace
}  // namespace talus
