// MPRGP against a brute-force active-set enumeration, and its stopping test.
#include "continuum/qp/mprgp.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace talus {
namespace {

struct DenseQp {
  Eigen::MatrixXd a;
  Eigen::VectorXd b, lower, upper;
};

DenseQp random_qp(int n, unsigned seed, bool two_sided) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&](Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); }));
  };
  const Eigen::MatrixXd factor = draw(n, n);
  DenseQp qp{factor * factor.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n),
             draw(n, 1),
             Eigen::VectorXd::Zero(n),
             {}};
  qp.b *= 3.0;
  qp.upper = Eigen::VectorXd::Constant(n, two_sided ? 0.2 : std::numeric_limits<double>::infinity());
  return qp;
}

/// Tries every assignment of {free, lower, upper} and keeps the one that satisfies the KKT conditions.
Eigen::VectorXd brute_force(const DenseQp& qp) {
  const Eigen::Index n = qp.b.size();
  int assignments = 1;
  for (Eigen::Index i = 0; i < n; ++i) assignments *= 3;
  for (int code = 0; code < assignments; ++code) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
    std::vector<Eigen::Index> free;
    bool possible = true;
    for (Eigen::Index i = 0, rest = code; i < n; ++i, rest /= 3) {
      if (rest % 3 == 0) free.push_back(i);
      if (rest % 3 == 1) x[i] = qp.lower[i];
      if (rest % 3 == 2) x[i] = qp.upper[i];
      possible = possible && std::isfinite(x[i]);
    }
    if (!possible) continue;
    if (!free.empty()) {
      const Eigen::VectorXd rhs = -(qp.a * x + qp.b);
      const Eigen::MatrixXd block = qp.a(free, free);
      const Eigen::VectorXd solution = block.llt().solve(Eigen::VectorXd(rhs(free)));
      x(free) = solution;
    }
    const Eigen::VectorXd g = qp.a * x + qp.b;
    bool optimal = true;
    for (Eigen::Index i = 0; i < n; ++i) {
      optimal = optimal && x[i] >= qp.lower[i] - 1e-12 && x[i] <= qp.upper[i] + 1e-12;
      if (x[i] > qp.lower[i] + 1e-12) optimal = optimal && g[i] <= 1e-9;
      if (x[i] < qp.upper[i] - 1e-12) optimal = optimal && g[i] >= -1e-9;
    }
    if (optimal) return x;
  }
  ADD_FAILURE() << "no KKT point found";
  return Eigen::VectorXd::Zero(n);
}

BoundQpResult solve(const DenseQp& qp, const BoundQpSettings& settings, Eigen::ArrayXd& x) {
  const auto apply = [&](const Eigen::ArrayXd& in, Eigen::ArrayXd& out) {
    out = (qp.a * in.matrix()).array();
  };
  const Eigen::VectorXd scale = qp.a.diagonal().cwiseSqrt().cwiseInverse();
  const double norm = (scale.asDiagonal() * qp.a * scale.asDiagonal()).eval().norm();
  return minimise_bound_qp(apply, qp.b.array(), qp.lower.array(), qp.upper.array(), qp.a.diagonal().array(),
                           norm, settings, x);
}

TEST(BoundQp, FindsTheBruteForceMinimiser) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const DenseQp qp = random_qp(6, seed, seed % 2 == 0);
    Eigen::ArrayXd x = Eigen::ArrayXd::Constant(6, 0.05);
    const auto result = solve(qp, {1e-10, 2000}, x);
    EXPECT_TRUE(result.converged) << "seed " << seed;
    EXPECT_LT((x.matrix() - brute_force(qp)).cwiseAbs().maxCoeff(), 1e-8) << "seed " << seed;
  }
}

TEST(BoundQp, WarmStartAtTheSolutionNeedsNoIteration) {
  const DenseQp qp = random_qp(6, 3, false);
  Eigen::ArrayXd x = brute_force(qp).array();
  EXPECT_EQ(solve(qp, {1e-8, 100}, x).iterations, 0);
}

TEST(BoundQp, VariablesWithEqualBoundsAreLeftAlone) {
  DenseQp qp = random_qp(6, 2, true);
  qp.upper[1] = qp.upper[4] = 0.0;
  Eigen::ArrayXd x = Eigen::ArrayXd::Constant(6, 0.05);
  const auto result = solve(qp, {1e-10, 2000}, x);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(x[1], 0.0);
  const Eigen::VectorXd g = qp.a * x.matrix() + qp.b;
  for (const Eigen::Index i : {0, 2, 3, 5}) {
    EXPECT_LE(x[i] > 1e-12 ? g[i] : 0.0, 1e-9);
    EXPECT_GE(x[i] < 0.2 - 1e-12 ? g[i] : 0.0, -1e-9);
  }
}

TEST(BoundQp, SaysWhenItStopsAtItsCap) {
  const DenseQp qp = random_qp(12, 1, false);
  Eigen::ArrayXd x = Eigen::ArrayXd::Zero(12);
  const auto result = solve(qp, {1e-14, 2}, x);
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.iterations, 2);
  EXPECT_GT(result.residual, 1e-14);
}

}  // namespace
}  // namespace talus
