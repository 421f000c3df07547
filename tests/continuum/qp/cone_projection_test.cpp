// The cone solver on random problems: feasibility, optimality, and the duality gap as a bound that holds.
#include "continuum/qp/cone_projection.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace talus {
namespace {

struct Problem {
  Eigen::MatrixXd k;  // faces x values
  Eigen::ArrayXd mass, free_velocity;
  BallBlocks balls;
};

Problem random_problem(unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(random); };
  Problem problem;
  problem.balls.size = {5, 2};
  problem.balls.count = {6, 4};
  const Eigen::Index values = problem.balls.values(), faces = 30;
  problem.k = Eigen::MatrixXd::NullaryExpr(faces, values, draw);
  problem.mass = Eigen::ArrayXd::NullaryExpr(faces, [&] { return 0.2 + std::abs(draw()); });
  problem.free_velocity = Eigen::ArrayXd::NullaryExpr(faces, draw);
  problem.balls.radius =
      Eigen::ArrayXd::NullaryExpr(problem.balls.blocks(), [&] { return 0.1 * std::abs(draw()); });
  problem.balls.radius[2] = 0.0;  // a stress-free cell
  problem.balls.curvature = Eigen::ArrayXd::Ones(problem.balls.blocks());
  return problem;
}

ConeProjectionResult solve(const Problem& p, const ConeProjectionSettings& settings, Eigen::ArrayXd& s,
                           Eigen::ArrayXd& v) {
  double lipschitz = 1.0;
  return project_onto_cone(
      [&](const Eigen::ArrayXd& in, Eigen::ArrayXd& out) { out = (p.k * in.matrix()).array(); },
      [&](const Eigen::ArrayXd& in, Eigen::ArrayXd& out) { out = (p.k.transpose() * in.matrix()).array(); },
      p.balls, p.mass, p.free_velocity, settings, lipschitz, s, v);
}

double energy(const Problem& p, const Eigen::ArrayXd& s) {
  const Eigen::ArrayXd v = p.free_velocity + (p.k * s.matrix()).array() / p.mass;
  return 0.5 * (p.mass * v.square()).sum();
}

TEST(ConeProjection, NoFeasibleStressLeavesLessEnergy) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Problem p = random_problem(seed);
    Eigen::ArrayXd s = Eigen::ArrayXd::Zero(p.balls.values()), v(p.mass.size());
    const auto result = solve(p, {1e-10, 20000}, s, v);
    ASSERT_TRUE(result.converged);
    Eigen::ArrayXd inside = s;
    project_onto_balls(p.balls, inside);
    EXPECT_LT((inside - s).abs().maxCoeff(), 1e-14);
    // Feasible rivals: random ones, and small projected moves away from the solution.
    std::mt19937_64 random(seed + 100);
    std::normal_distribution<double> normal;
    for (int rival = 0; rival < 200; ++rival) {
      const double size = rival % 2 == 0 ? 1.0 : 1e-3;
      Eigen::ArrayXd other = s + size * Eigen::ArrayXd::NullaryExpr(s.size(), [&] { return normal(random); });
      project_onto_balls(p.balls, other);
      EXPECT_GE(energy(p, other), energy(p, s) - 1e-10);
    }
  }
}

TEST(ConeProjection, GapBoundsTheDistanceToTheSolution) {
  const Problem p = random_problem(4);
  Eigen::ArrayXd exact = Eigen::ArrayXd::Zero(p.balls.values()), v_exact(p.mass.size());
  solve(p, {1e-14, 200000}, exact, v_exact);
  for (const double tolerance : {1e-1, 1e-3, 1e-6}) {
    Eigen::ArrayXd s = Eigen::ArrayXd::Zero(p.balls.values()), v(p.mass.size());
    const auto result = solve(p, {tolerance, 20000}, s, v);
    EXPECT_LE(energy(p, s) - energy(p, exact), result.gap + 1e-12);
    EXPECT_LE((p.mass * (v - v_exact).square()).sum(), result.gap + 1e-12);
  }
}

TEST(ConeProjection, WhatIsNotFiniteEndsAtTheCapUnconverged) {
  Problem p = random_problem(6);
  p.free_velocity[3] = std::nan("");
  Eigen::ArrayXd s = Eigen::ArrayXd::Zero(p.balls.values()), v(p.mass.size());
  const auto result = solve(p, {1e-6, 50}, s, v);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.iterations, 50);
}

TEST(ConeProjection, EndsWhenAskedForMoreThanRoundOffAllows) {
  const Problem p = random_problem(7);
  Eigen::ArrayXd s = Eigen::ArrayXd::Zero(p.balls.values()), v(p.mass.size());
  double lipschitz = 1.0;
  const auto result = project_onto_cone(
      [&](const Eigen::ArrayXd& in, Eigen::ArrayXd& out) { out = (p.k * in.matrix()).array(); },
      [&](const Eigen::ArrayXd& in, Eigen::ArrayXd& out) { out = (p.k.transpose() * in.matrix()).array(); },
      p.balls, p.mass, p.free_velocity, {1e-300, 5000}, lipschitz, s, v);
  EXPECT_LE(result.iterations, 5000);
  EXPECT_GE(result.gap, 0.0);
  EXPECT_LT(lipschitz, 1e4);
}

TEST(ConeProjection, SaysWhenItStopsAtItsCap) {
  const Problem p = random_problem(5);
  Eigen::ArrayXd s = Eigen::ArrayXd::Zero(p.balls.values()), v(p.mass.size());
  const auto result = solve(p, {1e-14, 3}, s, v);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.iterations, 3);
}

}  // namespace
}  // namespace talus
