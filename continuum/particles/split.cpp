// The halves of reshape.h: particles that are too long split.
#include <Eigen/Dense>
#include <cmath>

#include "continuum/particles/reshape.h"
#include "continuum/particles/semi_axis.h"

namespace talus {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double offset_share = 3.0 / 4.0;  // 5 d^2 / a^2: halves the semi-axis a

/// d e, by the eigenvector of the largest eigenvalue.
Vector3d offset_of_halves(const Matrix3d& shape) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(shape);
  const double square = eigen.eigenvalues()[2];
  Vector3d axis = eigen.eigenvectors().col(2);
  Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  if (axis[largest] < 0.0) axis = -axis;  // the solver leaves the sign open
  return std::sqrt(offset_share / 5.0 * square) * axis;
}

struct Halves {
  Index parent;
  Vector3d offset;  // d e, m
};

void write_halves(const Halves& halves, const Grid& grid, Index added, Particles& particles) {
  const auto& [parent, offset] = halves;
  particles.masses[parent] *= 0.5;
  set_shape_matrix(shape_matrix(particles, parent) - 5.0 * offset * offset.transpose(), particles, parent);
  particles.copy(parent, added);
  const Vector3d centre = particles.positions.col(parent);
  const Vector3d difference = gradient_matrix(particles, parent) * offset;
  particles.positions.col(parent) = grid.wrapped_position(centre + offset);
  particles.positions.col(added) = grid.wrapped_position(centre - offset);
  particles.velocities.col(parent) += difference;
  particles.velocities.col(added) -= difference;
}

}  // namespace

SplitReport split(const Grid& grid, std::span<const Material> materials, const Allowed& allowed,
                  const ReshapeRules& rules, Particles& particles) {
  SplitReport report;
  const double longest = rules.split_semi_axis * grid.spacing;
  const auto has_room = [&](const Vector3d& centre, const Vector3d& position) {
    return grid.contains(grid.wrapped_position(position)) && allowed(centre, position);
  };
  const auto too_light = [&](Index p) {
    const auto material = static_cast<std::size_t>(particles.materials[static_cast<std::size_t>(p)]);
    const double full = materials[material].max_density() * grid.cell_volume();
    return 0.5 * particles.masses[p] < rules.smallest_split_mass * full * (1.0 - 1e-9);
  };

  std::vector<Index> candidates;
  const double bound = std::pow(longest, 4);
  for (Index p = 0; p < particles.count(); ++p) {  // the norm of S is no less than its largest eigenvalue
    const auto s = particles.shapes.col(p).array().square();
    if (s.head<3>().sum() + 2.0 * s.tail<3>().sum() > 0.999 * bound) candidates.push_back(p);
  }
  for (int round = 0; round < most_split_rounds && !candidates.empty(); ++round) {
    std::vector<Halves> halved;
    for (const Index p : candidates) {
      if (!is_longer(shape_matrix(particles, p), longest)) continue;
      if (too_light(p)) {
        ++report.too_light;
        continue;
      }
      const Vector3d centre = particles.positions.col(p),
                     offset = offset_of_halves(shape_matrix(particles, p));
      if (!has_room(centre, centre + offset) || !has_room(centre, centre - offset)) {
        ++report.put_off;
      } else {
        halved.push_back({p, offset});
      }
    }
    candidates.clear();
    if (halved.empty()) break;
    Index added = particles.count();
    particles.resize(added + static_cast<Index>(halved.size()));
    for (const Halves& halves : halved) {
      write_halves(halves, grid, added, particles);
      candidates.insert(candidates.end(), {halves.parent, added});
      ++added;
    }
    report.splits += static_cast<Index>(halved.size());
  }
  for (const Index p : candidates) {
    if (is_longer(shape_matrix(particles, p), longest)) ++report.unfinished;
  }
  return report;
}

}  // namespace talus
