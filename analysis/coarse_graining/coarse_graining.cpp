#include "analysis/coarse_graining/coarse_graining.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "analysis/coarse_graining/branch_quadrature.h"

namespace talus::analysis {
namespace {

/// Spreads points over the grid; keeps its lists of weights from one point to the next.
class Spreader {
 public:
  Spreader(const CoarseGrid& grid, const Kernel& kernel) : grid_(grid), kernel_(kernel) {}

  /// Calls add(cell, W) for every cell that the kernel at `position` reaches; W in 1/m^3.
  template <class Add>
  void at(const Eigen::Vector3d& position, const Add& add) {
    for (int axis = 0; axis < 3; ++axis) {
      axis_weights(position[axis], axis, grid_, kernel_, weights_[static_cast<std::size_t>(axis)]);
    }
    const double density = 1.0 / grid_.cell_volume();
    for (const CellWeight& z : weights_[2]) {
      for (const CellWeight& y : weights_[1]) {
        for (const CellWeight& x : weights_[0]) {
          add(grid_.index(x.cell, y.cell, z.cell), density * x.weight * y.weight * z.weight);
        }
      }
    }
  }

 private:
  const CoarseGrid& grid_;
  const Kernel& kernel_;
  std::array<std::vector<CellWeight>, 3> weights_;
};

Eigen::Map<Eigen::Matrix3d> tensor(CoarseFields::Tensors& tensors, Eigen::Index cell) {
  return Eigen::Map<Eigen::Matrix3d>(tensors.col(cell).data());
}

CoarseFields empty_fields(Eigen::Index cells) {
  return {.volume_fraction = Eigen::VectorXd::Zero(cells),
          .density = Eigen::VectorXd::Zero(cells),
          .momentum_density = Eigen::Matrix3Xd::Zero(3, cells),
          .velocity = Eigen::Matrix3Xd::Constant(3, cells, std::numeric_limits<double>::quiet_NaN()),
          .kinetic_stress = CoarseFields::Tensors::Zero(9, cells),
          .contact_stress = CoarseFields::Tensors::Zero(9, cells)};
}

void require_inside(const Snapshot& snapshot, const CoarseGrid& grid) {
  for (int axis = 0; axis < 3; ++axis) {
    if (grid.edges[static_cast<std::size_t>(axis)] == Edge::periodic || snapshot.volumes.size() == 0)
      continue;
    const double low = snapshot.positions.row(axis).minCoeff();
    const double high = snapshot.positions.row(axis).maxCoeff();
    if (low >= grid.origin[axis] && high <= grid.origin[axis] + grid.length(axis)) continue;
    throw SnapshotError(fmt::format(
        "at t = {} s items lie from {} to {} m along {}, but the walls of the grid at {} and {} m",
        snapshot.time, low, high, "xyz"[axis], grid.origin[axis], grid.origin[axis] + grid.length(axis)));
  }
}

/// Mass, momentum, and for the time being the second moment of the velocity in place of the kinetic stress.
void add_grains(const Snapshot& snapshot, double grain_density, Spreader& spread, CoarseFields& fields) {
  for (Eigen::Index item = 0; item < snapshot.volumes.size(); ++item) {
    const double volume = snapshot.volumes[item];
    const double mass = grain_density * volume;
    const Eigen::Vector3d velocity = snapshot.velocities.col(item);
    const Eigen::Matrix3d second_moment = mass * velocity * velocity.transpose();
    spread.at(snapshot.positions.col(item), [&](Eigen::Index cell, double weight) {
      fields.volume_fraction[cell] += volume * weight;
      fields.density[cell] += mass * weight;
      fields.momentum_density.col(cell) += mass * weight * velocity;
      tensor(fields.kinetic_stress, cell) += weight * second_moment;
    });
  }
}

/// sum m v' v'^T W = sum m v v^T W - rho v v^T, as the mean of v' is zero.
void finish_velocity(CoarseFields& fields) {
  for (Eigen::Index cell = 0; cell < fields.density.size(); ++cell) {
    if (!(fields.density[cell] > 0.0)) continue;
    fields.velocity.col(cell) = fields.momentum_density.col(cell) / fields.density[cell];
    auto stress = tensor(fields.kinetic_stress, cell);
    stress = fields.momentum_density.col(cell) * fields.velocity.col(cell).transpose() - stress;
  }
}

/// From the other end to the centre, the short way round where the grid is periodic.
Eigen::Vector3d branch_of(const GrainContact& contact, const CoarseGrid& grid) {
  Eigen::Vector3d branch = contact.centre - contact.other;
  for (int axis = 0; axis < 3; ++axis) {
    if (grid.edges[static_cast<std::size_t>(axis)] != Edge::periodic) continue;
    branch[axis] -= grid.length(axis) * std::round(branch[axis] / grid.length(axis));
  }
  return branch;
}

void add_contacts(std::span<const GrainContact> contacts, const CoarseGrid& grid, const Kernel& kernel,
                  Spreader& spread, CoarseFields& fields) {
  std::vector<BranchPoint> points;
  for (const GrainContact& contact : contacts) {
    const Eigen::Vector3d branch = branch_of(contact, grid);
    const Eigen::Matrix3d moment = -contact.force * branch.transpose();
    branch_points(contact.centre, branch, grid, kernel, points);
    for (const BranchPoint& point : points) {
      spread.at(point.position, [&](Eigen::Index cell, double weight) {
        tensor(fields.contact_stress, cell) += point.weight * weight * moment;
      });
    }
  }
}

void require_finite(std::span<const GrainContact> contacts) {
  for (const GrainContact& contact : contacts) {
    if (contact.centre.allFinite() && contact.other.allFinite() && contact.force.allFinite()) continue;
    throw SnapshotError("a contact's ends or force are not finite");
  }
}

}  // namespace

Eigen::Matrix3d CoarseFields::stress(Eigen::Index cell) const {
  const Eigen::Matrix<double, 9, 1> sum = kinetic_stress.col(cell) + contact_stress.col(cell);
  return Eigen::Map<const Eigen::Matrix3d>(sum.data());
}

CoarseFields coarse_grain(const Snapshot& snapshot, double grain_density,
                          std::span<const GrainContact> contacts, const CoarseGrid& grid,
                          const Kernel& kernel) {
  check_grid(grid);
  check_kernel(kernel, grid);
  if (!(grain_density > 0.0) || !std::isfinite(grain_density)) {
    throw std::invalid_argument(fmt::format("coarse_grain: a grain density of {} kg/m^3", grain_density));
  }
  require_inside(snapshot, grid);
  require_finite(contacts);
  CoarseFields fields = empty_fields(grid.count());
  Spreader spread(grid, kernel);
  add_grains(snapshot, grain_density, spread, fields);
  finish_velocity(fields);
  add_contacts(contacts, grid, kernel, spread, fields);
  return fields;
}

}  // namespace talus::analysis
