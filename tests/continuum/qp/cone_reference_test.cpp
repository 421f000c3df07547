// The cone solver against block coordinate descent: slow, simple, exact in each block.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "continuum/qp/problem.h"
#include "tests/continuum/qp/collapse_problems.h"

namespace talus {
namespace {

/// Minimises 1/2 z'H z + g'z over |z| <= radius: a shift >= 0 of the spectrum of H brings z onto the ball.
Eigen::VectorXd minimise_in_ball(const Eigen::MatrixXd& h, const Eigen::VectorXd& g, double radius) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(h);
  const Eigen::ArrayXd values = eigen.eigenvalues().array().max(0.0);
  const Eigen::ArrayXd along = (eigen.eigenvectors().transpose() * g).array();
  const auto at_shift = [&](double shift) -> Eigen::ArrayXd {
    return (along.abs() > 0.0).select(-along / (values + shift), 0.0);
  };
  double low = 0.0, high = g.norm() / radius;  // |z(shift)| <= |g| / shift
  if (at_shift(0.0).isFinite().all() && at_shift(0.0).matrix().norm() <= radius)
    return eigen.eigenvectors() * at_shift(0.0).matrix();
  for (int bisection = 0; bisection < 200; ++bisection) {
    const double middle = 0.5 * (low + high);
    (at_shift(middle).matrix().norm() > radius ? low : high) = middle;
  }
  return eigen.eigenvectors() * at_shift(high).matrix();
}

struct Reference {
  Eigen::ArrayXd s, velocity;
};

/// Sweeps over the blocks until a sweep no longer changes any velocity.
Reference coordinate_descent(const ConeQp& problem, int most_sweeps) {
  const Eigen::MatrixXd k = problem.k;
  const Eigen::VectorXd inverse_mass =
      (problem.mass > 0.0).select(problem.mass.max(1e-300).inverse(), 0.0).matrix();
  Eigen::VectorXd s = Eigen::VectorXd::Zero(k.cols()), v = problem.free_velocity.matrix();
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    const Eigen::VectorXd before = v;
    problem.balls.for_each([&](Eigen::Index block, Eigen::Index offset, int size) {
      const double radius = problem.balls.radius[block];
      const Eigen::MatrixXd columns = k.middleCols(offset, size);
      const Eigen::MatrixXd h = columns.transpose() * inverse_mass.asDiagonal() * columns;
      const Eigen::VectorXd old = s.segment(offset, size);
      const Eigen::VectorXd next = radius > 0.0
                                       ? minimise_in_ball(h, columns.transpose() * v - h * old, radius)
                                       : Eigen::VectorXd::Zero(size);
      v += inverse_mass.asDiagonal() * (columns * (next - old));
      s.segment(offset, size) = next;
    });
    if ((v - before).cwiseAbs().maxCoeff() <= 1e-15 * v.cwiseAbs().maxCoeff()) break;
  }
  return {s.array(), v.array()};
}

/// Velocities are unique, stresses need not be.
void expect_agreement(ConeQp problem) {
  const double energy_before = 0.5 * (problem.mass * problem.free_velocity.square()).sum();
  problem.settings = {1e-14 * energy_before, 200000};
  const ConeQpSolution ours = solve(problem);
  EXPECT_TRUE(ours.result.converged);
  const Reference reference = coordinate_descent(problem, 20000);
  const double ours_energy = objective(problem, ours.s), reference_energy = objective(problem, reference.s);
  EXPECT_LT(optimality_residual(problem, reference.s), 1e-10 * energy_before);
  EXPECT_NEAR(ours_energy, reference_energy, 1e-12 * energy_before);
  const double velocities =
      (ours.velocity - reference.velocity).abs().maxCoeff() / problem.free_velocity.abs().maxCoeff();
  EXPECT_LT(velocities, 1e-6);
  std::printf("%s, %td values: %d iterations, energies differ by %.1e of the initial, velocities by %.1e\n",
              problem.name.c_str(), ours.s.size(), ours.result.iterations,
              std::abs(ours_energy - reference_energy) / energy_before, velocities);
}

TEST(ConeReference, AgreesOnRandomProblems) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const auto draw = [&] { return normal(random); };
    ConeQp problem;
    problem.name = "random";
    problem.balls = {{5, 2},
                     {4, 3},
                     Eigen::ArrayXd::NullaryExpr(7, [&] { return 0.3 * std::abs(draw()); }),
                     Eigen::ArrayXd::Ones(7)};
    problem.balls.radius[1] = 0.0;
    problem.k = Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(30, problem.balls.values(), draw)).sparseView();
    problem.mass = Eigen::ArrayXd::NullaryExpr(30, [&] { return 0.2 + std::abs(draw()); });
    problem.free_velocity = Eigen::ArrayXd::NullaryExpr(30, draw);
    problem.start = Eigen::ArrayXd::NullaryExpr(problem.balls.values(), draw);
    problem.lipschitz = 1.0;
    expect_agreement(problem);
  }
}

TEST(ConeReference, AgreesOnTheFrictionOfATinyCollapse) {
  expect_agreement(testing::friction_problem(testing::collapse_moment({3, 1, 3}, 3)));
  expect_agreement(testing::friction_problem(testing::collapse_moment({2, 2, 2}, 3)));
}

// Descent by blocks is slow here: as far as it comes, both must lie within their duality gaps of the least energy. Ours gets to a gap of
// 3e-10 in 20,000 iterations, and to 1e-10 not in a million.
TEST(ConeReference, AgreesOnTheFrictionAtBodies) {
  auto problem = std::get<ConeQp>(testing::step_with_bodies(0.01).last("friction"));
  const double energy_before = 0.5 * (problem.mass * problem.free_velocity.square()).sum();
  problem.settings = {1e-9 * energy_before, 200000};
  const ConeQpSolution ours = solve(problem);
  EXPECT_TRUE(ours.result.converged);
  const Reference reference = coordinate_descent(problem, 2000);
  const double our_gap = optimality_residual(problem, ours.s),
               gap = optimality_residual(problem, reference.s),
               apart = objective(problem, ours.s) - objective(problem, reference.s);
  EXPECT_LT(gap, 1e-4 * energy_before);
  EXPECT_LE(apart, our_gap);
  EXPECT_GE(apart, -gap);
  const double velocities =
      (ours.velocity - reference.velocity).abs().maxCoeff() / problem.free_velocity.abs().maxCoeff();
  EXPECT_LT(velocities, 1e-4);
  std::printf(
      "friction with bodies, %td values: gaps %.1e and %.1e of the initial energy, velocities differ by "
      "%.1e\n",
      ours.s.size(), our_gap / energy_before, gap / energy_before, velocities);
}

}  // namespace
}  // namespace talus
