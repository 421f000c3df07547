// What holds for any particles: splitting and merging conserve, and one undoes the other. RC_PARAMS sets the number of
// cases and the seed; a failure prints what reproduces it.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "continuum/particles/reshape.h"
#include "tests/continuum/particles/particle_sums.h"

namespace talus {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::relative_difference;
using testing::Sums;
using testing::sums_of;

constexpr double tolerance = 1e-13;  // relative to the terms of each sum
constexpr double dt = 0.01;
const std::vector<Material> materials{{"sand", 2500.0, 0.6, 0.5}, {"gravel", 2700.0, 0.55, 0.7}};
const Grid grid{{-0.5, -0.5, -0.5}, 1.0, {1, 1, 1}, {false, false, false}};  // one cell

bool everywhere(const Vector3d&, const Vector3d&) { return true; }

/// Whatever may merge or split by its shape, in a cell as large as needed.
ReshapeRules loose_rules() {
  ReshapeRules rules;
  rules.split_semi_axis = 0.3;
  rules.merge_semi_axis = 10.0;
  rules.merge_distance = 10.0;
  rules.merge_speed = 1e9;
  rules.largest_merged_mass = 1e9;
  rules.smallest_split_mass = 0.0;
  rules.fewest_in_cell = 0;
  return rules;
}

/// Uniform: at RapidCheck's full size, for at smaller ones ranges shrink to their lower ends.
double number(double low, double high) {
  const auto whole = rc::gen::inRange<std::int64_t>(0, 1'000'000'001);
  return low + (high - low) * 1e-9 * static_cast<double>(*rc::gen::resize(rc::kNominalSize, whole));
}

/// Any particle with semi-axes from 0.003 to 0.45 and a centre within 0.1 of the cell's.
void add_any_particle(bool with_gradient, Particles& particles) {
  Eigen::Quaterniond turn(number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1));
  if (turn.norm() < 1e-3) turn = Eigen::Quaterniond::Identity();
  const Matrix3d axes = turn.normalized().toRotationMatrix();
  const Vector3d squares =
      Vector3d(number(0.01, 0.45), number(0.01, 0.45), number(0.003, 0.45)).array().square();
  testing::add_particle({number(-0.1, 0.1), number(-0.1, 0.1), number(-0.1, 0.1)}, std::exp(number(-3, 3)),
                        axes * squares.asDiagonal() * axes.transpose(), particles);
  const Eigen::Index p = particles.count() - 1;
  for (double& v : particles.velocities.col(p)) v = number(-5, 5);
  if (with_gradient)
    for (double& v : particles.gradients.col(p)) v = number(-5, 5);
}

RC_GTEST_PROP(ReshapeProperty, SplittingConservesEverythingEnergyToo, (bool with_gradient)) {
  Particles particles;
  add_any_particle(with_gradient, particles);
  const Sums before = sums_of(particles);
  const double longest =
      std::sqrt(Eigen::SelfAdjointEigenSolver<Matrix3d>(shape_matrix(particles, 0)).eigenvalues()[2]);
  const SplitReport report = split(grid, materials, everywhere, loose_rules(), particles);
  RC_ASSERT((report.splits > 0) == (longest > 0.3 && report.put_off == 0));
  RC_CLASSIFY(report.splits > 0, "split");
  const Sums after = sums_of(particles);
  RC_ASSERT(relative_difference(before, after) < tolerance);
  RC_ASSERT(std::abs(before.energy - after.energy) <= tolerance * before.energy);
}

RC_GTEST_PROP(ReshapeProperty, MergingConservesAllButTheEnergyItReports, (bool with_gradient)) {
  Particles particles;
  add_any_particle(with_gradient, particles);
  add_any_particle(with_gradient, particles);
  const Sums before = sums_of(particles);
  const MergeReport report = merge(grid, materials, everywhere, loose_rules(), dt, particles);
  RC_ASSERT(report.merges == 1);
  RC_ASSERT(particles.count() == 1);
  Sums after = sums_of(particles);
  RC_ASSERT(report.energy_lost > -tolerance * before.energy);
  RC_ASSERT(std::abs(before.energy - after.energy - report.energy_lost) <= 1e-12 * before.energy);
  // Without a gradient the spin is lost; with one, or with one velocity, it is not.
  if (particles.gradients.isZero(0.0)) after.moment_of_velocity = before.moment_of_velocity;
  RC_ASSERT(relative_difference(before, after) < tolerance);
}

RC_GTEST_PROP(ReshapeProperty, MergingAPairOfOneVelocityKeepsAngularMomentumAndEnergy, ()) {
  Particles particles;
  add_any_particle(false, particles);
  add_any_particle(false, particles);
  particles.velocities.col(1) = particles.velocities.col(0);
  const Sums before = sums_of(particles);
  const MergeReport report = merge(grid, materials, everywhere, loose_rules(), dt, particles);
  RC_ASSERT(report.merges == 1);
  RC_ASSERT(report.energy_lost == 0.0);
  RC_ASSERT(relative_difference(before, sums_of(particles)) < tolerance);
}

RC_GTEST_PROP(ReshapeProperty, MergingTheHalvesGivesTheParticleBack, (bool with_gradient)) {
  Particles particles;
  add_any_particle(with_gradient, particles);
  const Particles before = particles;
  ReshapeRules rules = loose_rules();
  // Just below the longest semi-axis, so that it splits once.
  rules.split_semi_axis =
      0.999 * std::sqrt(Eigen::SelfAdjointEigenSolver<Matrix3d>(shape_matrix(particles, 0)).eigenvalues()[2]);
  const SplitReport report = split(grid, materials, everywhere, rules, particles);
  RC_PRE(report.splits == 1);
  RC_ASSERT(merge(grid, materials, everywhere, rules, dt, particles).merges == 1);
  RC_ASSERT(particles.masses[0] == before.masses[0]);
  RC_ASSERT((particles.positions - before.positions).norm() < tolerance);
  RC_ASSERT((particles.velocities - before.velocities).norm() <= 10.0 * tolerance);
  RC_ASSERT((particles.shapes - before.shapes).norm() < tolerance * before.shapes.norm());
  // Found through S^-1, whose condition is at most (0.45 / 0.003)^2.
  RC_ASSERT((particles.gradients - before.gradients).norm() <= 1e-10 * before.gradients.norm());
}

RC_GTEST_PROP(ReshapeProperty, MaterialsNeverMix, (std::vector<bool> kinds)) {
  Particles particles;
  std::array<double, 2> before{}, after{};
  for (const bool kind : kinds) {
    add_any_particle(false, particles);
    particles.materials.back() = kind;
    before[kind] += particles.masses[particles.count() - 1];
  }
  const auto pairs = static_cast<Eigen::Index>(std::count(kinds.begin(), kinds.end(), true) / 2 +
                                               std::count(kinds.begin(), kinds.end(), false) / 2);
  const auto report = merge(grid, materials, everywhere, loose_rules(), dt, particles);
  for (Eigen::Index p = 0; p < particles.count(); ++p)
    after[static_cast<std::size_t>(particles.materials[static_cast<std::size_t>(p)])] += particles.masses[p];
  for (const int kind : {0, 1}) RC_ASSERT(std::abs(after[kind] - before[kind]) <= 1e-12 * before[kind]);
  RC_ASSERT(report.merges == pairs);
}

RC_GTEST_PROP(ReshapeProperty, CrowdsConserveAndKeepTheirEight, ()) {
  Particles particles;
  const int count = *rc::gen::inRange(0, 40);
  for (int p = 0; p < count; ++p) add_any_particle(true, particles);
  const Sums before = sums_of(particles);
  ReshapeRules rules = loose_rules();
  rules.fewest_in_cell = 8;
  rules.merge_semi_axis = 0.4;
  const ReshapeReport report = split_and_merge(grid, materials, everywhere, rules, dt, particles);
  RC_CLASSIFY(report.merge.merges > 0, "merged");
  RC_CLASSIFY(report.split.splits > 0, "split");
  RC_ASSERT(particles.count() == count + report.split.splits - report.merge.merges);
  RC_ASSERT(report.merge.merges == 0 || particles.count() >= 8);
  if (count > 0) RC_ASSERT(relative_difference(before, sums_of(particles)) < tolerance);
}

}  // namespace
}  // namespace talus
