// Friction in 3-D: four copies of the stress a cell against eight, and ADMM with an inexact velocity step against APGD.
// Results: continuum/stress/solver_study.md. Run by hand:
//
//   copies_study copies FILE...   iterations and seconds with four and with eight, and how far the velocities are apart
//   copies_study strength         resistance to shear waves in all directions, four and eight
//   copies_study admm FILE...     iterations and seconds to the gap asked for when recorded, and to 1/100 of it
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "continuum/stress/friction.h"
#include "tests/continuum/study/friction_problem.h"

namespace {

using namespace talus;
using namespace talus::study;
using Index = Eigen::Index;

/// Which copy of a cell touches, in the other parity, the edge along `axis` that copy k touches in its own.
Index other_copy(int axis, Index k) { return axis == 0 ? 3 - k : axis == 1 ? (k + 2) % 4 : k ^ 1; }

/// Where a value of the copies of the other parity stands in K: a cell's twelve edges are the same, each copy takes three
/// others, which meet at the opposite corner.
Index column_of_other(Index value) {
  const Index copy = value / components_per_copy, component = value % components_per_copy;
  if (component < 2) return value;
  const Index cell = copy / copies_per_cell;
  return components_per_copy *
             (copies_per_cell * cell + other_copy(static_cast<int>(component) - 2, copy % copies_per_cell)) +
         component;
}

/// Copies at all eight corners: both parities, each with half of its share of the stress.
ConeQp with_eight_copies(const ConeQp& four) {
  const Index copies = four.balls.count[0], values = components_per_copy * copies,
              rest = four.k.cols() - values;
  std::vector<Eigen::Triplet<double>> entries;
  const auto take = [&](Index from, Index to, double share) {
    for (Columns::InnerIterator it(four.k, from); it; ++it)
      entries.emplace_back(static_cast<int>(it.row()), static_cast<int>(to), share * it.value());
  };
  ConeQp eight = four;
  eight.start.resize(2 * values + rest);
  eight.start.segment(0, values) = four.start.head(values);
  eight.start.tail(rest) = four.start.tail(rest);
  for (Index v = 0; v < values; ++v) {
    take(v, v, 0.5);
    take(column_of_other(v), values + v, 0.5);
    eight.start[values + v] = four.start[column_of_other(v)];
  }
  for (Index v = 0; v < rest; ++v) take(values + v, 2 * values + v, 1.0);
  eight.k = Columns(four.k.rows(), 2 * values + rest);
  eight.k.setFromTriplets(entries.begin(), entries.end());
  // Curvatures by the rule of FrictionOperator::blocks, from the lengths of columns.
  const Array inverse_mass = (four.mass > 0.0).select(four.mass.max(1e-300).inverse(), 0.0);
  const auto length = [&](Index column) {
    double sum = 0.0;
    for (Columns::InnerIterator it(four.k, column); it; ++it)
      sum += inverse_mass[it.row()] * it.value() * it.value();
    return sum;
  };
  eight.balls.count[0] = 2 * copies;
  eight.balls.radius.resize(2 * copies + four.balls.count[1]);
  eight.balls.curvature.resize(2 * copies + four.balls.count[1]);
  for (Index b = 0; b < copies; ++b) {
    double curvature = 3.0 * (length(components_per_copy * b) + length(components_per_copy * b + 1));
    for (Index c = 2; c < components_per_copy; ++c)
      curvature = std::max(curvature, 4.0 * length(column_of_other(components_per_copy * b + c)));
    eight.balls.radius[b] = eight.balls.radius[copies + b] = four.balls.radius[b];
    eight.balls.curvature[b] = 0.5 * four.balls.curvature[b];
    eight.balls.curvature[copies + b] = curvature > 0.0 ? 0.5 * curvature : 0.5 * four.balls.curvature[b];
  }
  eight.balls.radius.tail(four.balls.count[1]) = four.balls.radius.tail(four.balls.count[1]);
  eight.balls.curvature.tail(four.balls.count[1]) = four.balls.curvature.tail(four.balls.count[1]);
  return eight;
}

struct Solved {
  Outcome outcome;
  Array velocity;
};

Solved solve_by_apgd(const Work& work, double tolerance) {
  Solved solved;
  solved.outcome =
      projected_gradient(work, tolerance, Momentum::accelerated,
                         [&](int, const Array&, const Array& v, const Array&) { solved.velocity = v; });
  return solved;
}

/// As recorded, the start is what four copies left in the step before; so both start from no stress too.
void copies(const std::string& file) {
  ConeQp recorded = read_cone(file), bare = recorded;
  bare.start.setZero();
  const Work four(std::move(recorded)), eight(with_eight_copies(four.problem)), four_bare(std::move(bare)),
      eight_bare(with_eight_copies(four_bare.problem));
  const double tolerance = four.problem.settings.gap_tolerance, mass = four.problem.mass.sum();
  const double scale = 100.0 * std::sqrt(tolerance / mass);  // g dt
  const auto length = [&](const Array& v) { return std::sqrt(four.dot(v, v) / mass) / scale; };
  fmt::print("{}: {} faces, {} and {} values\n", file, four.k.rows(), four.k.cols(), eight.k.cols());
  const auto solve_all = [&](double share) {
    const std::array<std::pair<const char*, const Work*>, 4> all{{{"four, recorded start", &four},
                                                                  {"eight, recorded start", &eight},
                                                                  {"four, no stress", &four_bare},
                                                                  {"eight, no stress", &eight_bare}}};
    std::array<Array, 4> velocities;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Solved solved = solve_by_apgd(*all[i].second, share * tolerance);
      velocities[i] = solved.velocity;
      const Outcome& o = solved.outcome;
      fmt::print("  {:<22} {} of the gap: {:>5}{} iterations {:>8.3f} s\n", all[i].first, share, o.iterations,
                 o.converged ? ' ' : '*', o.seconds);
    }
    return velocities;
  };
  solve_all(1.0);
  const auto velocities = solve_all(0.01);
  const Array &a = velocities[0], &b = velocities[1], &free = four.problem.free_velocity;
  const double energy_of_friction = four.dot(free, free) - four.dot(a, a);
  fmt::print(
      "  in g dt: friction changes v by {:.4f}; four and eight differ by {:.5f}, two solves with four by "
      "{:.5f}; "
      "energy taken out {:+.3f} %\n",
      length(free - a), length(a - b), length(a - velocities[2]),
      100.0 * ((four.dot(free, free) - four.dot(b, b)) / energy_of_friction - 1.0));
  std::fflush(stdout);
}

/// A box full of sand, periodic along every axis.
ActiveRegion full_box(int cells) {
  const Grid grid{Eigen::Vector3d::Zero(), 1.0, Eigen::Vector3i::Constant(cells), {true, true, true}};
  Eigen::Matrix3Xd centres(3, grid.cells.prod());
  for (int c = 0; c < grid.cells.prod(); ++c)
    centres.col(c) = grid.cell_of_index(c).cast<double>().array() + 0.5;
  return make_active_region(grid, {}, centres);
}

/// sum over copies of |e| for v = t cos(k.x + phase), per what a continuum dissipates with the same yield stress.
double strength(const ActiveRegion& region, const FrictionOperator& friction, const Eigen::Vector3d& wave,
                const Eigen::Vector3d& along, double phase) {
  Field velocity = Field::Zero(region.open_faces + 1);
  for (int cell = 0; cell < region.cell_count(); ++cell) {
    const Eigen::Vector3d centre =
        region.grid.cell_of_index(region.dense_of_cell[static_cast<std::size_t>(cell)])
            .cast<double>()
            .array() +
        0.5;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d at = centre - 0.5 * Eigen::Vector3d::Unit(axis);
      velocity[region.cell_faces[static_cast<std::size_t>(cell)][static_cast<std::size_t>(2 * axis)]] =
          along[axis] * std::cos(wave.dot(at) + phase);
    }
  }
  Eigen::ArrayXd strain(components_per_copy * copies_per_cell * region.cell_count());
  friction.apply_transpose(velocity, strain);
  double sum = 0.0;
  for (Index copy = 0; copy < strain.size() / components_per_copy; ++copy)
    sum += std::sqrt(strain.segment<components_per_copy>(components_per_copy * copy).square().sum());
  const double continuum = wave.norm() * along.norm() / std::numbers::sqrt2 * 2.0 / std::numbers::pi;
  return sum / region.cell_count() / continuum;
}

/// Shear waves of about a length, of all directions and polarisations on a grid: means over phases, and single phases.
void strength_of(int cells, double length) {
  constexpr int phases = 8;
  const ActiveRegion even = full_box(cells);
  ActiveRegion odd = even;
  for (int& parity : odd.cell_parity) parity = 1 - parity;
  const FrictionOperator of_even(even), of_odd(odd);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> angle(0.0, 2.0 * std::numbers::pi);
  std::vector<double> four, eight;
  double apart = 0.0, of_phase_four = 0.0, of_phase_eight = 0.0;
  const double wanted = cells / length;
  const int most = static_cast<int>(wanted) + 1;
  for (int x = 0; x <= most; ++x)
    for (int y = 0; y <= most; ++y)
      for (int z = 0; z <= most; ++z) {
        const Eigen::Vector3d n(x, y, z);
        if (std::abs(n.norm() - wanted) > 0.3) continue;
        const Eigen::Vector3d wave = 2.0 * std::numbers::pi / cells * n, u = n.unitOrthogonal(),
                              w = n.normalized().cross(u);
        const double turn = angle(random);
        const Eigen::Vector3d along = std::cos(turn) * u + std::sin(turn) * w;
        double mean_four = 0.0, mean_eight = 0.0;
        std::vector<double> fours, eights;
        for (int p = 0; p < phases; ++p) {
          const double phase = angle(random);
          const double a = strength(even, of_even, wave, along, phase),
                       b = strength(odd, of_odd, wave, along, phase);
          fours.push_back(a);
          eights.push_back(0.5 * (a + b));
          apart = std::max(apart, std::abs(a - b) / (a + b));
          mean_four += a / phases;
          mean_eight += 0.5 * (a + b) / phases;
        }
        const auto spread = [](const std::vector<double>& v) {
          return *std::max_element(v.begin(), v.end()) / *std::min_element(v.begin(), v.end()) - 1.0;
        };
        of_phase_four = std::max(of_phase_four, spread(fours));
        of_phase_eight = std::max(of_phase_eight, spread(eights));
        four.push_back(mean_four);
        eight.push_back(mean_eight);
      }
  const auto [low4, high4] = std::minmax_element(four.begin(), four.end());
  const auto [low8, high8] = std::minmax_element(eight.begin(), eight.end());
  fmt::print(
      "waves of {} cells, {} directions: strength over a continuum's, four {:.4f} to {:.4f}, eight {:.4f} to "
      "{:.4f}; "
      "with phase, four {:.3f} %, eight {:.3f} %; four and eight of one wave differ by at most {:.3f} %\n",
      length, four.size(), *low4, *high4, *low8, *high8, 100.0 * of_phase_four, 100.0 * of_phase_eight,
      100.0 * apart);
}

/// ADMM as friction_study has it, but for the velocity step: conjugate gradients that start from the last velocity,
/// preconditioned by one incomplete Cholesky factor a solve (Eigen::IncompleteCholesky), or exact where `steps` is 0.
Outcome alternating(const Work& work, double tolerance, double share, int steps) {
  Watch watch(tolerance);
  const Array mass = (work.problem.mass > 0.0).select(work.problem.mass, 1e-12);
  const Array first = work.strain(work.velocity(work.problem.start));
  const double typical = std::sqrt(first.square().mean()) + 1e-300;
  Array penalty(first.size());
  const double mean_radius = work.problem.balls.radius.mean();
  work.problem.balls.for_each([&](Index block, Index offset, int size) {
    penalty.segment(offset, size) =
        share * std::max(work.problem.balls.radius[block], 1e-3 * mean_radius) / typical;
  });
  Columns matrix = work.problem.k * penalty.matrix().asDiagonal() * Columns(work.problem.k.transpose());
  for (Index f = 0; f < mass.size(); ++f) matrix.coeffRef(f, f) += mass[f];
  const Rows product = matrix;
  Eigen::IncompleteCholesky<double> incomplete;
  Eigen::SimplicialLDLT<Columns> factor;
  if (steps == 0)
    factor.compute(matrix);
  else
    incomplete.compute(matrix);
  Array s = work.problem.start;
  work.project(s);
  Eigen::VectorXd w = work.velocity(s).matrix();
  Array e = work.strain(w.array());
  for (int iteration = 0;; ++iteration) {
    const auto gap = [&] {
      const Array v = work.velocity(s);
      return std::min(work.gap(s, v, v), work.gap(s, v, w.array()));
    };
    if (watch.stops(iteration, gap)) return watch.outcome();
    const Eigen::VectorXd right =
        (mass * work.problem.free_velocity).matrix() + work.k * (s + penalty * e).matrix();
    if (steps == 0) {
      w = factor.solve(right);
    } else {
      Eigen::VectorXd residual = right - product * w, direction = incomplete.solve(residual);
      double energy = residual.dot(direction);
      for (int step = 0; step < steps && energy > 0.0; ++step) {
        const Eigen::VectorXd applied = product * direction;
        const double length = energy / direction.dot(applied);
        w += length * direction;
        if (step + 1 == steps) break;
        residual -= length * applied;
        const Eigen::VectorXd scaled = incomplete.solve(residual);
        const double next = residual.dot(scaled);
        direction = scaled + next / energy * direction;
        energy = next;
      }
    }
    const Array ahead = s - penalty * (1.6 * work.strain(w.array()) - 0.6 * e);
    s = ahead;
    work.project(s);
    e = (s - ahead) / penalty;
  }
}

void admm(const std::string& file) {
  const Work work(read_cone(file));
  const double tolerance = work.problem.settings.gap_tolerance;
  fmt::print("{}: {} faces, {} values (* not reached)\n", file, work.k.rows(), work.k.cols());
  const auto row = [&](const std::string& name, const auto& method) {
    const Outcome plain = method(tolerance), tight = method(0.01 * tolerance);
    const auto mark = [](const Outcome& o) { return o.converged ? ' ' : '*'; };
    fmt::print("  {:<34} {:>6}{} {:>8.3f} s   {:>6}{} {:>8.3f} s\n", name, plain.iterations, mark(plain),
               plain.seconds, tight.iterations, mark(tight), tight.seconds);
    std::fflush(stdout);
  };
  row("APGD", [&](double t) { return solve_by_apgd(work, t).outcome; });
  for (const int steps : {1, 3, 0}) {
    for (const double share : {0.3, 3.0, 10.0, 30.0}) {
      row(fmt::format("ADMM, penalty {} r/e, {}", share, steps ? fmt::format("{} CG", steps) : "exact"),
          [&](double t) { return alternating(work, t, share, steps); });
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view command = argc > 1 ? argv[1] : "";
  if (command == "strength" && argc == 2) {
    for (const double length : {16.0, 8.0, 4.0, 3.0}) strength_of(16, length);
  } else if ((command == "copies" || command == "admm") && argc > 2) {
    for (int i = 2; i < argc; ++i) {
      if (command == "admm")
        admm(argv[i]);
      else
        copies(argv[i]);
    }
  } else {
    fmt::print(stderr, "usage: copies_study copies FILE... | admm FILE... | strength\n");
    return 2;
  }
}
