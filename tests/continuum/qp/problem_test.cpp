// Problems as values: what their residuals mean, what makes them defective, and that solving them is what the solver does.
#include "continuum/qp/problem.h"

#include <gmock/gmock.h>

#include "continuum/stress/friction.h"
#include "continuum/stress/pressure.h"
#include "tests/continuum/qp/collapse_problems.h"

namespace talus {
namespace {

using ::testing::HasSubstr;

const testing::CollapseMoment& moment() {
  static const auto moment = testing::collapse_moment({6, 1, 6}, 5);
  return moment;
}

/// minimise x^2 + y^2 - 4 x - 4 y in the box [0, 1] x [0, 3]: (1, 2).
BoundQp small_problem() {
  Eigen::SparseMatrix<double> matrix(2, 2);
  matrix.insert(0, 0) = 2.0;
  matrix.insert(1, 1) = 2.0;
  matrix.makeCompressed();
  return {"small",
          matrix,
          Eigen::Array2d(-4.0, -4.0),
          Eigen::Array2d(0.0, 0.0),
          Eigen::Array2d(1.0, 3.0),
          Eigen::Array2d(0.5, 0.5),
          1.0,
          {1e-12, 100}};
}

TEST(BoundProblem, IsSolvedAndJudged) {
  const BoundQp problem = small_problem();
  const BoundQpSolution solution = solve(problem);
  EXPECT_EQ(solution.x[0], 1.0);
  EXPECT_NEAR(solution.x[1], 2.0, 1e-12);
  EXPECT_NEAR(objective(problem, solution.x), -7.0, 1e-12);
  EXPECT_LT(optimality_residual(problem, solution.x), 1e-12);
}

TEST(BoundProblem, ResidualCountsOnlyWhatCanStillMove) {
  const BoundQp problem = small_problem();
  EXPECT_EQ(optimality_residual(problem, Eigen::Array2d(1.0, 1.0)), 2.0);
  EXPECT_EQ(optimality_residual(problem, Eigen::Array2d(0.0, 2.0)),
            4.0);  // at a bound, but it pulls away from it
  EXPECT_EQ(optimality_residual(problem, Eigen::Array2d(1.1, 2.0)), std::numeric_limits<double>::infinity());
}

TEST(BoundProblem, VariablesEndExactlyAtTheirBounds) {
  // Bounds and scales that do not survive a division and a multiplication.
  BoundQp problem = testing::shear_problem(moment(), 1);
  problem.settings = {1e-12 * problem.linear.abs().maxCoeff(), 10000};
  const BoundQpSolution solution = solve(problem);
  ASSERT_TRUE(solution.result.converged);
  EXPECT_GT((solution.x == problem.upper || solution.x == problem.lower).count(), 10);
  EXPECT_LE(optimality_residual(problem, solution.x), 2.0 * problem.settings.tolerance);
}

TEST(BoundProblem, RecordedPressureIsTheMatrixFreeOne) {
  BoundQp problem = testing::pressure_problem(moment(), moment().velocity);
  problem.settings.tolerance *= 1e-9;
  const ActiveRegion& region = moment().region;
  const Eigen::Index n = region.cell_count();
  Field inverse_mass = Field::Zero(region.open_faces + 1), velocity = inverse_mass;
  inverse_mass.head(region.open_faces) = moment().inverse_mass;
  velocity.head(region.open_faces) = moment().velocity;
  const Field room = (packed_fill - moment().grid.fill).max(0.0) * (region.grid.spacing / moment().dt);
  Field pressure = moment().stress.pressure;
  const auto matrix_free = solve_pressure(region, inverse_mass, velocity, room, problem.settings, pressure);
  const auto recorded = solve(problem);
  ASSERT_TRUE(matrix_free.converged && recorded.result.converged);
  EXPECT_LT((recorded.x - pressure.head(n)).abs().maxCoeff(), 1e-9 * pressure.maxCoeff());
  EXPECT_LT(matrix_free.iterations, recorded.result.iterations);
}

TEST(ConeProblem, RecordedFrictionIsTheMatrixFreeOne) {
  const ConeQp problem = testing::friction_problem(moment());
  const ActiveRegion& region = moment().region;
  const FrictionOperator friction(region);
  Field mass = Field::Zero(region.open_faces + 1), free_velocity = mass, velocity = mass;
  mass.head(region.open_faces) = problem.mass;
  free_velocity.head(region.open_faces) = problem.free_velocity;
  Eigen::ArrayXd copies = problem.start;
  double lipschitz = problem.lipschitz;
  const auto matrix_free =
      project_onto_cone([&](const Eigen::ArrayXd& s, Field& impulse) { friction.apply(s, impulse); },
                        [&](const Field& v, Eigen::ArrayXd& strain) { friction.apply_transpose(v, strain); },
                        problem.balls, mass, free_velocity, problem.settings, lipschitz, copies, velocity);
  const ConeQpSolution recorded = solve(problem);
  ASSERT_TRUE(matrix_free.converged && recorded.result.converged);
  EXPECT_NEAR(recorded.lipschitz, lipschitz, 1e-6 * lipschitz);
  EXPECT_EQ(recorded.result.iterations, matrix_free.iterations);
  EXPECT_LT((recorded.velocity - velocity.head(region.open_faces)).abs().maxCoeff(),
            1e-9 * velocity.abs().maxCoeff());
}

TEST(Problem, WhatIsRecordedWithBodiesIsWhatTheStepSolved) {
  const testing::BodyStep step = testing::step_with_bodies(1e-4);
  const auto& friction = std::get<ConeQp>(step.last("friction"));
  const auto& pressure = std::get<BoundQp>(step.last("pressure"));
  EXPECT_EQ(friction.mass.tail(12).minCoeff(),
            0.0);  // six modes of the ball, and six that are told how to move
  EXPECT_EQ(friction.mass.tail(12).sum(), 6.0);
  // Stresses need not be unique; what they do is.
  const Eigen::VectorXd by_step = friction.k * step.stress.copies.matrix(),
                        by_problem = friction.k * solve(friction).s.matrix();
  EXPECT_LT((by_step - by_problem).norm(), 1e-3 * by_problem.norm());
  EXPECT_GT(by_problem.tail(12).norm(), 0.01 * by_problem.norm());
  const Eigen::ArrayXd x = solve(pressure).x, in_step = step.stress.pressure.head(x.size());
  EXPECT_LT((x - in_step).abs().maxCoeff(), 1e-3 * x.maxCoeff());
}

TEST(ConeProblem, ResidualIsTheDualityGap) {
  const ConeQp problem = testing::friction_problem(moment());
  const ConeQpSolution solution = solve(problem);
  EXPECT_NEAR(optimality_residual(problem, solution.s), solution.result.gap, 1e-6 * solution.result.gap);
  // E less the dual value at v: 1/2 v'M v - (-1/2 v'M v + v'M v_0 - sum r |K'v|).
  const Eigen::ArrayXd v = solution.velocity;
  const Eigen::ArrayXd strain = (problem.k.transpose() * v.matrix()).array();
  double dual = -0.5 * (problem.mass * v.square()).sum() + (problem.mass * v * problem.free_velocity).sum();
  problem.balls.for_each([&](Eigen::Index block, Eigen::Index offset, int size) {
    dual -= problem.balls.radius[block] * strain.segment(offset, size).matrix().norm();
  });
  EXPECT_NEAR(optimality_residual(problem, solution.s), objective(problem, solution.s) - dual,
              1e-12 * objective(problem, solution.s));
  EXPECT_EQ(optimality_residual(problem, Eigen::ArrayXd::Constant(solution.s.size(), 1e6)),
            std::numeric_limits<double>::infinity());
}

TEST(Problem, DefectsAreNamed) {
  const auto defect = [](const auto& problem, auto&& change) {
    auto changed = problem;
    change(changed);
    return find_defect(changed).value_or("none");
  };
  const BoundQp bound = small_problem();
  EXPECT_EQ(find_defect(bound), std::nullopt);
  EXPECT_THAT(defect(bound, [](BoundQp& qp) { qp.name = "../x"; }), HasSubstr("name '../x'"));
  EXPECT_THAT(defect(bound, [](BoundQp& qp) { qp.linear.conservativeResize(1); }),
              HasSubstr("linear has 1 values instead of 2"));
  EXPECT_THAT(defect(bound, [](BoundQp& qp) { qp.linear[1] = std::nan(""); }),
              HasSubstr("linear is not finite"));
  EXPECT_THAT(defect(bound, [](BoundQp& qp) { qp.lower[1] = 4.0; }), HasSubstr("above its upper bound"));
  EXPECT_THAT(defect(bound, [](BoundQp& qp) { qp.upper[1] = std::nan(""); }),
              HasSubstr("above its upper bound"));
  EXPECT_THAT(defect(bound,
                     [](BoundQp& qp) {
                       qp.matrix.insert(0, 1) = 1.0;
                       qp.matrix.makeCompressed();
                     }),
              HasSubstr("not symmetric"));
  EXPECT_THAT(defect(bound, [](BoundQp& qp) { qp.norm = 0.0; }), HasSubstr("norm 0"));
  EXPECT_THAT(defect(bound, [](BoundQp& qp) { qp.settings.max_iterations = -1; }),
              HasSubstr("max_iterations -1"));
  const ConeQp cone = testing::friction_problem(moment());
  EXPECT_EQ(find_defect(cone), std::nullopt);
  EXPECT_THAT(defect(cone, [](ConeQp& qp) { qp.mass[0] = -1.0; }), HasSubstr("mass is negative"));
  EXPECT_THAT(defect(cone, [](ConeQp& qp) { qp.balls.radius[3] = -1.0; }), HasSubstr("radius is negative"));
  EXPECT_THAT(defect(cone, [](ConeQp& qp) { qp.balls.curvature[3] = 0.0; }),
              HasSubstr("curvature is not positive"));
  EXPECT_THAT(defect(cone, [](ConeQp& qp) { qp.balls.count[0] += 1; }), HasSubstr("but the blocks hold"));
  EXPECT_THAT(defect(cone, [](ConeQp& qp) { qp.start.conservativeResize(3); }),
              HasSubstr("start has 3 values"));
}

TEST(Problem, NormBoundCoversTheSpectrum) {
  EXPECT_NEAR(scaled_norm_bound(testing::pressure_problem(moment(), moment().velocity).matrix), 2.0, 1e-12);
  EXPECT_EQ(scaled_norm_bound(small_problem().matrix), 1.0);
}

}  // namespace
}  // namespace talus
