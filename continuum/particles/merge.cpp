// The other half of reshape.h: close, small particles of one material merge.
#include <Eigen/Dense>
#include <algorithm>

#include "continuum/particles/reshape.h"

namespace talus {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr Index most_candidates = 64;  // keeps the cost proportional to the number of particles

Matrix3d gradient_of(const Particles& particles, Index p) {
  return particles.gradients.col(p).reshaped<Eigen::ColMajor>(3, 3);
}

/// The particles of each cell, in their order; those outside the domain are in none.
struct Cells {
  std::vector<Index> first;      // cells + 1
  std::vector<Index> particles;  // from first[cell] up to first[cell + 1]
};

Cells particles_by_cell(const Grid& grid, const Particles& particles) {
  std::vector<int> cell(static_cast<std::size_t>(particles.count()), -1);
  Cells cells;
  cells.first.assign(static_cast<std::size_t>(grid.cells.prod()) + 1, 0);
  for (Index p = 0; p < particles.count(); ++p) {
    const Vector3d position = particles.positions.col(p);
    if (!grid.contains(position)) continue;
    const int c = cell[static_cast<std::size_t>(p)] = grid.cell_index(grid.cell_at(position));
    ++cells.first[static_cast<std::size_t>(c) + 1];
  }
  for (std::size_t c = 1; c < cells.first.size(); ++c) cells.first[c] += cells.first[c - 1];
  cells.particles.resize(static_cast<std::size_t>(cells.first.back()));
  std::vector<Index> next(cells.first.begin(), cells.first.end() - 1);
  for (std::size_t p = 0; p < cell.size(); ++p) {
    if (cell[p] < 0) continue;
    cells.particles[static_cast<std::size_t>(next[static_cast<std::size_t>(cell[p])]++)] =
        static_cast<Index>(p);
  }
  return cells;
}

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

/// False too where the shape is not finite.
bool fits(const Matrix3d& shape, double longest) {
  const double square = longest * longest;
  if (shape.norm() <= square) return true;  // no less than the largest eigenvalue
  if (!(shape.diagonal().maxCoeff() <= square) || !shape.allFinite()) return false;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(shape, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()[2] <= square;
}

/// Kinetic energy within a particle per mass, tr(C S C^T) / 10, J/kg.
double inner_energy(const Matrix3d& gradient, const Matrix3d& shape) {
  return (gradient * shape).cwiseProduct(gradient).sum() / 10.0;
}

/// Writes the union over particle i; returns the kinetic energy lost, J.
double write_union(const Union& u, Index i, Index j, Particles& particles) {
  const double w = u.share, both = w * (1.0 - w);
  double energy_lost = u.mass * 0.5 * both * u.jump.squaredNorm();
  const Matrix3d gradient_i = gradient_of(particles, i), gradient_j = gradient_of(particles, j);
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
  return energy_lost;
}

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

  void merge_within(std::span<const Index> cell, MergeReport& report) {
    auto left = static_cast<Index>(cell.size());
    for (std::size_t a = 0; a < cell.size() && left > fewest_; ++a) {
      if (gone_[static_cast<std::size_t>(cell[a])]) continue;
      const Index j = partner(cell[a], cell.subspan(a + 1));
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
  /// The nearest of `others`, which come after i, that may merge with it; -1 where none may.
  Index partner(Index i, std::span<const Index> others) const {
    Index nearest = -1;
    double distance = distance_;
    const int material = particles_.materials[static_cast<std::size_t>(i)];
    Index seen = 0;
    for (const Index j : others) {
      if (++seen > most_candidates) break;
      if (gone_[static_cast<std::size_t>(j)]) continue;
      if (particles_.materials[static_cast<std::size_t>(j)] != material) continue;
      const double gap = (particles_.positions.col(j) - particles_.positions.col(i)).norm();
      if (!(gap < distance)) continue;
      const Union u = unite(particles_, i, j);
      if (!(u.jump.norm() <= speed_) || !(u.mass <= heaviest_[static_cast<std::size_t>(material)])) continue;
      if (!fits(u.shape, longest_) || !allowed_(u.position)) continue;
      nearest = j;
      distance = gap;
    }
    return nearest;
  }

  const Allowed& allowed_;
  Particles& particles_;
  double longest_, distance_, speed_;
  Index fewest_;
  std::vector<double> heaviest_;  // of each material, kg
  std::vector<bool> gone_;        // into an earlier one
};

}  // namespace

MergeReport merge(const Grid& grid, std::span<const Material> materials, const Allowed& allowed,
                  const ReshapeRules& rules, double dt, Particles& particles) {
  MergeReport report;
  const Cells cells = particles_by_cell(grid, particles);
  Merger merger(grid, materials, allowed, rules, dt, particles);
  for (std::size_t c = 0; c + 1 < cells.first.size(); ++c) {
    const auto first = static_cast<std::size_t>(cells.first[c]);
    const auto last = static_cast<std::size_t>(cells.first[c + 1]);
    merger.merge_within(std::span(cells.particles).subspan(first, last - first), report);
  }
  if (report.merges > 0) merger.remove_merged();
  return report;
}

}  // namespace talus
