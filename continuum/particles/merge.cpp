// The other half of reshape.h: close, small particles of one material merge.
#include <Eigen/Dense>
#include <algorithm>

#include "continuum/grid/points_by_cell.h"
#include "continuum/parallel.h"
#include "continuum/particles/reshape.h"
#include "continuum/particles/semi_axis.h"

namespace talus {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr Index most_candidates = 64;  // keeps the cost proportional to the number of particles
constexpr std::ptrdiff_t cells_in_block = 64;

/// What does not depend on gradients, which only a pair that merges needs.
struct Union {
  double mass, share;  // m, and w = m_j / m
  Vector3d gap, jump;
  Vector3d position;
  Matrix3d shape;
};

Union unite(const Particles& particles, Index i, Index j) {
  Union u;
  u.mass = particles.masses[i] + particles.masses[j];
  u.share = particles.masses[j] / u.mass;
  u.gap = particles.positions.col(j) - particles.positions.col(i);
  u.jump = particles.velocities.col(j) - particles.velocities.col(i);
  u.position = particles.positions.col(i) + u.share * u.gap;
  u.shape = (1.0 - u.share) * shape_matrix(particles, i) + u.share * shape_matrix(particles, j) +
            5.0 * u.share * (1.0 - u.share) * u.gap * u.gap.transpose();
  return u;
}

/// Kinetic energy within a particle per mass, tr(C S C^T) / 10, J/kg.
double inner_energy(const Matrix3d& gradient, const Matrix3d& shape) {
  return (gradient * shape).cwiseProduct(gradient).sum() / 10.0;
}

/// Writes the union over particle i; returns the kinetic energy lost, J.
double write_union(const Union& u, Index i, Index j, Particles& particles) {
  const double w = u.share, both = w * (1.0 - w);
  double energy_lost = u.mass * 0.5 * both * u.jump.squaredNorm();
  const Matrix3d gradient_i = gradient_matrix(particles, i), gradient_j = gradient_matrix(particles, j);
  if (!gradient_i.isZero(0.0) || !gradient_j.isZero(0.0)) {
    const Matrix3d shape_i = shape_matrix(particles, i), shape_j = shape_matrix(particles, j);
    const Matrix3d moment =
        (1.0 - w) * gradient_i * shape_i + w * gradient_j * shape_j + 5.0 * both * u.jump * u.gap.transpose();
    const Matrix3d gradient = u.shape.ldlt().solve(moment.transpose()).transpose();
    particles.gradients.col(i) = gradient.reshaped<Eigen::ColMajor>(9, 1);
    energy_lost += u.mass * ((1.0 - w) * inner_energy(gradient_i, shape_i) +
                             w * inner_energy(gradient_j, shape_j) - inner_energy(gradient, u.shape));
  }
  particles.velocities.col(i) += w * u.jump;
  particles.positions.col(i) = u.position;
  particles.masses[i] = u.mass;
  set_shape_matrix(u.shape, particles, i);
  if (particles.has_origins()) {  // halves that merge again have one origin, not the same twice
    const int other = particles.origins(0, j);
    particles.origins(1, i) = other == particles.origins(0, i) ? -1 : other;
  }
  return energy_lost;
}

/// Squared distances between the particles of a cell. A particle that merges moves, but is asked about no more.
class Near {
 public:
  void read(const Particles& particles, std::span<const int> cell) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      along_[axis].resize(cell.size());
      for (std::size_t a = 0; a < cell.size(); ++a)
        along_[axis][a] = particles.positions(static_cast<Index>(axis), cell[a]);
    }
  }
  /// To those that come after `a`, at most most_candidates.
  auto squared_gaps(std::size_t a) {
    const Index count = std::min(most_candidates, std::ssize(along_[0]) - static_cast<Index>(a) - 1);
    const auto squared = [&](const std::vector<double>& along) {
      return (Eigen::Map<const Eigen::ArrayXd>(along.data() + a + 1, count) - along[a]).square();
    };
    gaps_.head(count) = squared(along_[0]) + squared(along_[1]) + squared(along_[2]);
    return gaps_.head(count);
  }

 private:
  std::array<std::vector<double>, 3> along_;  // positions
  Eigen::Array<double, most_candidates, 1> gaps_;
};

class Merger {
 public:
  Merger(const Grid& grid, std::span<const Material> materials, const Allowed& allowed,
         const ReshapeRules& rules, double dt, Particles& particles)
      : allowed_(allowed),
        particles_(particles),
        longest_(rules.merge_semi_axis * grid.spacing),
        distance_(rules.merge_distance * grid.spacing),
        speed_(rules.merge_speed * grid.spacing / dt),
        fewest_(rules.fewest_in_cell),
        gone_(static_cast<std::size_t>(particles.count())) {
    for (const Material& material : materials) {
      heaviest_.push_back(rules.largest_merged_mass * material.max_density() * grid.cell_volume() *
                          (1.0 + 1e-9));  // the halves of a particle that is just as heavy may merge again
    }
  }

  /// `cell`: its particles, in their order.
  void merge_within(std::span<const int> cell, Near& near, MergeReport& report) {
    auto left = static_cast<Index>(cell.size());
    if (left <= fewest_) return;
    near.read(particles_, cell);
    for (std::size_t a = 0; a < cell.size() && left > fewest_; ++a) {
      if (gone_[static_cast<std::size_t>(cell[a])]) continue;
      const Index j = partner(cell, a, near);
      if (j < 0) continue;
      report.energy_lost += write_union(unite(particles_, cell[a], j), cell[a], j, particles_);
      gone_[static_cast<std::size_t>(j)] = true;
      ++report.merges;
      --left;
    }
  }

  void remove_merged() {
    Index kept = 0;
    for (Index p = 0; p < particles_.count(); ++p) {
      if (gone_[static_cast<std::size_t>(p)]) continue;
      if (p != kept) particles_.copy(p, kept);
      ++kept;
    }
    particles_.resize(kept);
  }

 private:
  /// The nearest of those behind place `a` of the cell that may merge with it; -1 where none may.
  Index partner(std::span<const int> cell, std::size_t a, Near& near) const {
    Index nearest = -1;
    double squared_distance = distance_ * distance_;
    const Index i = cell[a];
    const auto squared_gaps = near.squared_gaps(a);
    for (Index k = 0; k < squared_gaps.size(); ++k) {
      if (!(squared_gaps[k] < squared_distance)) continue;
      const Index j = cell[a + 1 + static_cast<std::size_t>(k)];
      if (!may_merge(i, j)) continue;
      nearest = j;
      squared_distance = squared_gaps[k];
    }
    return nearest;
  }

  /// But for their distance.
  bool may_merge(Index i, Index j) const {
    const int material = particles_.materials[static_cast<std::size_t>(i)];
    if (gone_[static_cast<std::size_t>(j)] || particles_.materials[static_cast<std::size_t>(j)] != material)
      return false;
    if (!(particles_.masses[i] + particles_.masses[j] <= heaviest_[static_cast<std::size_t>(material)]))
      return false;
    if (!((particles_.velocities.col(j) - particles_.velocities.col(i)).norm() <= speed_)) return false;
    // The union is no shorter along the grid's axes than its parts are together.
    const double share = particles_.masses[j] / (particles_.masses[i] + particles_.masses[j]);
    const auto diagonal =
        (1.0 - share) * particles_.shapes.col(i).head<3>() + share * particles_.shapes.col(j).head<3>();
    if (diagonal.maxCoeff() > longest_ * longest_) return false;
    const Union u = unite(particles_, i, j);
    return u.shape.allFinite() && !is_longer(u.shape, longest_) &&
           allowed_(particles_.positions.col(i), u.position) &&
           allowed_(particles_.positions.col(j), u.position);
  }

  const Allowed& allowed_;
  Particles& particles_;
  double longest_, distance_, speed_;
  Index fewest_;
  std::vector<double> heaviest_;  // of each material, kg
  std::vector<char> gone_;        // into an earlier one
};

}  // namespace

MergeReport merge(const Grid& grid, std::span<const Material> materials, const Allowed& allowed,
                  const ReshapeRules& rules, double dt, Particles& particles) {
  const PointsByCell points = points_by_cell(grid, particles.positions);
  Merger merger(grid, materials, allowed, rules, dt, particles);
  const auto block = [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    MergeReport report;
    static thread_local std::vector<int> cell;  // keeps its memory, as `near` does
    static thread_local Near near;
    for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c) {
      cell.clear();
      for (int place = points.first[c]; place < points.first[c + 1]; ++place)
        cell.push_back(points.point(place));
      merger.merge_within(cell, near, report);
    }
    return report;
  };
  const MergeReport report = sum_over_blocks<MergeReport>(points.cell_count(), cells_in_block, block);
  if (report.merges > 0) merger.remove_merged();
  return report;
}

}  // namespace talus
