#include "continuum/particles/deform.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace talus {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double unit_sphere = 4.0 / 3.0 * std::numbers::pi;
constexpr double round_off = 1e-12;  // relative; a volume this near to its bound is at it

/// Raises semi-axes that are too thin; true where there were any.
bool bound_axis_ratio(Matrix3d& shape) {
  constexpr double ratio = largest_axis_ratio * largest_axis_ratio;  // of eigenvalues
  const double trace = shape.trace();
  if (!(trace > 0.0)) {  // crushed to a point: no direction is left
    shape = Matrix3d::Identity();
    return true;
  }
  // Most need no eigenvalues: the smallest is at least 4 det / trace^2, and the largest at most the trace.
  if (4.0 * ratio * (shape / trace).determinant() >= 1.0) return false;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(shape / trace);
  const double longest = eigen.eigenvalues()[2];
  if (eigen.eigenvalues()[0] >= longest / ratio * (1.0 - round_off)) return false;
  const Vector3d raised = trace * eigen.eigenvalues().cwiseMax(longest / ratio);
  shape = eigen.eigenvectors() * raised.asDiagonal() * eigen.eigenvectors().transpose();
  return true;
}

/// Scaled as a whole.
void set_volume(double volume, Matrix3d& shape) {
  const Matrix3d unit = shape / shape.trace();
  shape = std::pow(volume / shape_volume(unit), 2.0 / 3.0) * unit;
}

}  // namespace

double shape_volume(const Matrix3d& shape) {
  const double trace = shape.trace();
  if (!(trace > 0.0)) return 0.0;
  // Through a shape of trace 1: the determinant itself overflows long before S does.
  return unit_sphere * trace * std::sqrt(trace) * std::sqrt(std::max(0.0, (shape / trace).determinant()));
}

DeformReport deform(const Eigen::Matrix<double, 9, Eigen::Dynamic>& velocity_gradients, double dt,
                    std::span<const Material> materials, double cell_size, Particles& particles) {
  DeformReport report;
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    const Matrix3d map =
        Matrix3d::Identity() + dt * velocity_gradients.col(p).reshaped<Eigen::ColMajor>(3, 3);
    Matrix3d shape = map * shape_matrix(particles, p) * map.transpose();
    if (!std::isfinite(shape.trace())) {  // no entry of a positive matrix is larger, and any NaN reaches it
      ++report.not_finite;
      continue;
    }
    report.thickened += bound_axis_ratio(shape);

    const auto material = static_cast<std::size_t>(particles.materials[static_cast<std::size_t>(p)]);
    const double least = particles.masses[p] / materials[material].max_density();
    const double most = std::max(least, cell_size * cell_size * cell_size);
    const double volume = shape_volume(shape);
    if (volume < least * (1.0 - round_off)) {
      set_volume(least, shape);
      ++report.enlarged;
    } else if (volume > most * (1.0 + round_off)) {
      set_volume(most, shape);
      ++report.reduced;
    }
    set_shape_matrix(shape, particles, p);
  }
  return report;
}

}  // namespace talus
