// Ways to solve a recorded friction problem, compared: iterations and seconds to the gap asked for when it was recorded and
// to 1/100 of it. All work on the sparse K of the file, so that seconds compare among each other, not with the solver on
// rows. Results: continuum/stress/solver_study.md. Run by hand:
//
//   friction_study table FILE...   a row per problem, method and tolerance
//   friction_study trace FILE      how APGD converges: energy above the minimum, gap at v, gap at the mean velocity
#include <fmt/format.h>

#include <Eigen/SparseCholesky>
#include <cstring>
#include <string>
#include <vector>

#include "tests/continuum/study/friction_problem.h"

namespace {

using namespace talus;
using namespace talus::study;

/// Spectral projected gradient (Birgin, Martinez & Raydan 2000), scaled by curvature, nonmonotone over 10 steps.
Outcome spectral(const Work& work, double tolerance) {
  Watch watch(tolerance);
  Array s = work.problem.start;
  work.project(s);
  Array v = work.velocity(s), e = work.strain(v);
  double step = 0.5;
  std::vector<double> energies{0.5 * work.dot(v, v)};
  for (int iteration = 0;; ++iteration) {
    if (watch.stops(iteration, [&] { return work.gap(s, v, v); })) return watch.outcome();
    Array d = s - step * e / work.curvature;
    work.project(d);
    d -= s;
    const Array dv = work.inverse_mass * (work.k * d.matrix()).array();
    const double slope = (e * d).sum(), length = work.dot(dv, dv), energy = energies.back();
    const std::size_t first = energies.size() > 10 ? energies.size() - 10 : 0;
    const double highest =
        *std::max_element(energies.begin() + static_cast<std::ptrdiff_t>(first), energies.end());
    double share = 1.0;
    if (energy + slope + 0.5 * length > highest + 1e-4 * slope)
      share = std::clamp(-slope / length, 0.05, 1.0);
    s += share * d;
    v += share * dv;
    e = work.strain(v);
    energies.push_back(0.5 * work.dot(v, v));
    // Barzilai-Borwein in the metric of the curvature.
    step = length > 0.0 ? std::clamp((work.curvature * d.square()).sum() / length, 1e-3, 1e3) : 1.0;
  }
}

/// Primal-dual hybrid gradient (Chambolle & Pock 2011) with the diagonal steps of Pock & Chambolle (2011), accelerated or not:
/// minimise 1/2 |w - v0|^2_M + sum r |K'w| by w and s.
Outcome primal_dual(const Work& work, double tolerance, double balance) {
  Watch watch(tolerance);
  const Rows absolute = work.transposed.cwiseAbs();
  const Array of_values = (absolute * Eigen::VectorXd::Ones(work.k.rows())).array().max(1e-300);
  const Array of_faces = (Rows(work.k.cwiseAbs()) * Eigen::VectorXd::Ones(work.k.cols())).array().max(1e-300);
  // Scaled so that both steps are dimensionless: w in units of its mass.
  const double mean_mass = work.problem.mass.sum() / std::max<double>(1.0, (work.problem.mass > 0.0).count());
  const Array sigma = balance * mean_mass / of_values, tau = 1.0 / (balance * mean_mass * of_faces);
  Array s = work.problem.start;
  work.project(s);
  Array w = work.velocity(s), ahead = w;
  for (int iteration = 0;; ++iteration) {
    const auto gap = [&] {
      const Array v = work.velocity(s);
      return std::min(work.gap(s, v, v), work.gap(s, v, w));
    };
    if (watch.stops(iteration, gap)) return watch.outcome();
    s -= sigma * work.strain(ahead);
    work.project(s);
    const Array impulse = (work.k * s.matrix()).array();
    const Array next = (work.problem.mass > 0.0)
                           .select((w + tau * (impulse + work.problem.mass * work.problem.free_velocity)) /
                                       (1.0 + tau * work.problem.mass),
                                   work.problem.free_velocity);
    ahead = 2.0 * next - w;
    w = next;
  }
}

/// ADMM on e = K'v, with penalty proportional to the radius, over-relaxed; the velocity by one Cholesky factor a solve.
Outcome alternating(const Work& work, double tolerance, double share) {
  Watch watch(tolerance);
  const Array mass = work.problem.mass;
  // The penalty that makes s = penalty * e as large as the radius at a typical strain.
  const Array first = work.strain(work.velocity(work.problem.start));
  const double typical = std::sqrt(first.square().mean()) + 1e-300;
  Array penalty(first.size());
  const double mean_radius = work.problem.balls.radius.mean();
  work.problem.balls.for_each([&](Eigen::Index block, Eigen::Index offset, int size) {
    penalty.segment(offset, size) =
        share * std::max(work.problem.balls.radius[block], 1e-3 * mean_radius) / typical;
  });
  Columns matrix = work.problem.k * penalty.matrix().asDiagonal() * Columns(work.problem.k.transpose());
  for (Eigen::Index f = 0; f < mass.size(); ++f) matrix.coeffRef(f, f) += mass[f] > 0.0 ? mass[f] : 1e-12;
  Eigen::SimplicialLDLT<Columns> factor(matrix);
  Array s = work.problem.start;
  work.project(s);
  Array w = work.velocity(s), e = work.strain(w);
  for (int iteration = 0;; ++iteration) {
    const auto gap = [&] {
      Array inside = s;
      work.project(inside);
      const Array v = work.velocity(inside);
      return std::min(work.gap(inside, v, v), work.gap(inside, v, w));
    };
    if (watch.stops(iteration, gap)) return watch.outcome();
    // minimise 1/2|w - v0|^2_M - s.(K'w - e) + penalty/2 |K'w - e|^2, with the multiplier -s.
    const Eigen::VectorXd right =
        (mass * work.problem.free_velocity).matrix() + work.k * (s + penalty * e).matrix();
    w = factor.solve(right).array();
    const Array strain = 1.6 * work.strain(w) - 0.6 * e;
    const Array ahead = s - penalty * strain;
    s = ahead;
    work.project(s);
    e = (s - ahead) / penalty;  // shrunk by the radius
    // The multiplier stays inside its ball: s is it.
  }
}

/// Newton on v with the stress kept as a variable (Chan, Golub & Mulet 1999): s |e| + r e = 0, |e| smoothed by
/// `smoothing`, which falls as the gap does. An iteration is one factorisation.
Outcome newton(const Work& work, double tolerance) {
  Watch watch(tolerance, 1);
  const BallBlocks& balls = work.problem.balls;
  Array s = work.problem.start;
  work.project(s);
  Array w = work.velocity(s);
  double smoothing = std::sqrt(work.strain(w).square().mean()) + 1e-300;
  Eigen::SimplicialLDLT<Columns> factor;
  bool analysed = false;
  const Columns kt = work.problem.k.transpose();
  for (int iteration = 0;; ++iteration) {
    const auto gap = [&] {
      Array inside = s;
      work.project(inside);
      const Array v = work.velocity(inside);
      return std::min(work.gap(inside, v, v), work.gap(inside, v, w));
    };
    if (watch.stops(iteration, gap)) return watch.outcome();
    const Array e = work.strain(w);
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(6 * s.size()));
    Array pull(s.size());  // -r e / |e|, the stress at this strain
    balls.for_each([&](Eigen::Index block, Eigen::Index offset, int size) {
      const auto own = e.segment(offset, size);
      const auto stress = s.segment(offset, size);
      const double radius = balls.radius[block], norm = std::sqrt(own.square().sum() + smoothing * smoothing);
      pull.segment(offset, size) = -radius * own / norm;
      for (int i = 0; i < size; ++i) {
        for (int j = 0; j < size; ++j) {
          // ds/de = -(r I + (s e' + e s') / (2 |e|)) / |e|: symmetrised, s kept.
          const double value =
              ((i == j ? radius : 0.0) + 0.5 * (stress[i] * own[j] + own[i] * stress[j]) / norm) / norm;
          entries.emplace_back(static_cast<int>(offset + i), static_cast<int>(offset + j), value);
        }
      }
    });
    Columns weight(s.size(), s.size());
    weight.setFromTriplets(entries.begin(), entries.end());
    Columns matrix = work.problem.k * Columns(weight * kt);
    for (Eigen::Index f = 0; f < w.size(); ++f)
      matrix.coeffRef(f, f) += work.problem.mass[f] > 0.0 ? work.problem.mass[f] : 1e-12;
    if (!analysed) factor.analyzePattern(matrix);
    analysed = true;
    factor.factorize(matrix);
    // Residual of M (w - v0) = K s with s by its law.
    const Eigen::VectorXd residual =
        (work.problem.mass * (w - work.problem.free_velocity)).matrix() - work.k * pull.matrix();
    const Array step = -factor.solve(residual).array();
    const auto value = [&](const Array& at) {
      double sum = 0.5 * work.dot(at - work.problem.free_velocity, at - work.problem.free_velocity);
      const Array strain = work.strain(at);
      balls.for_each([&](Eigen::Index block, Eigen::Index offset, int size) {
        sum += balls.radius[block] *
               std::sqrt(strain.segment(offset, size).square().sum() + smoothing * smoothing);
      });
      return sum;
    };
    double share = 1.0;
    const double before = value(w);
    const double slope = (residual.array() * step).sum();
    while (share > 1e-3 && value(w + share * step) > before + 1e-4 * share * slope) share *= 0.5;
    const Array e_step = work.strain(step);
    s = pull - (weight * e_step.matrix()).array();
    // Where the stress leaves its ball it is put back; the weights assume it inside.
    work.project(s);
    w += share * step;
    smoothing *= share > 0.5 ? 0.3 : 0.8;
  }
}

void print(const std::string& name, const Outcome& plain, const Outcome& tight) {
  const auto mark = [](const Outcome& o) { return o.converged ? ' ' : '*'; };
  fmt::print("  {:<28} {:>6}{} {:>8.3f} s   {:>6}{} {:>8.3f} s\n", name, plain.iterations, mark(plain),
             plain.seconds, tight.iterations, mark(tight), tight.seconds);
  std::fflush(stdout);
}

void table(const std::string& file) {
  const Work work(read_cone(file));
  const double tolerance = work.problem.settings.gap_tolerance;
  Array start = work.problem.start;
  work.project(start);
  fmt::print("{}: {} faces, {} values, first gap {:.3g} of the tolerance (* not reached)\n", file,
             work.k.rows(), work.k.cols(), work.gap(start) / tolerance);
  const auto row = [&](const std::string& name, const auto& method) {
    const Outcome plain = method(tolerance);
    print(name, plain, method(0.01 * tolerance));
  };
  const auto nothing = [](int, const Array&, const Array&, const Array&) {};
  row("APGD", [&](double t) { return projected_gradient(work, t, Momentum::accelerated, nothing); });
  row("APGD, gap at mean velocity",
      [&](double t) { return projected_gradient(work, t, Momentum::accelerated_mean, nothing); });
  row("projected gradient", [&](double t) { return projected_gradient(work, t, Momentum::none, nothing); });
  row("spectral", [&](double t) { return spectral(work, t); });
  for (const double balance : {1e2, 1e3, 1e4})
    row(fmt::format("primal-dual, balance {}", balance),
        [&](double t) { return primal_dual(work, t, balance); });
  for (const double share : {0.3, 3.0, 10.0, 30.0})
    row(fmt::format("ADMM, penalty {} r/e", share), [&](double t) { return alternating(work, t, share); });
  row("Newton, stress kept", [&](double t) { return newton(work, t); });
}

void trace(const std::string& file) {
  const Work work(read_cone(file));
  const double tolerance = work.problem.settings.gap_tolerance;
  double least = 1e300;
  projected_gradient(work, 1e-5 * tolerance, Momentum::accelerated,
                     [&](int i, const Array&, const Array& v, const Array&) {
                       if (i % 20 == 0) least = std::min(least, 0.5 * work.dot(v, v));
                     });
  fmt::print("{}: in units of the gap tolerance\n{:>6} {:>12} {:>12} {:>12}\n", file, "it", "E - E*", "gap v",
             "gap mean");
  projected_gradient(work, 0.01 * tolerance, Momentum::accelerated,
                     [&](int i, const Array& s, const Array& v, const Array& mean) {
                       if (i % 10 != 0 || i > 600) return;
                       fmt::print("{:>6} {:>12.4g} {:>12.4g} {:>12.4g}\n", i,
                                  (0.5 * work.dot(v, v) - least) / tolerance, work.gap(s, v, v) / tolerance,
                                  work.gap(s, v, mean) / tolerance);
                     });
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 2; i < argc; ++i) {
    if (std::strcmp(argv[1], "trace") == 0)
      trace(argv[i]);
    else
      table(argv[i]);
  }
}
