#include "continuum/particles/deform.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "continuum/particles/eigen_lanes.h"

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

DeformReport& DeformReport::operator+=(const DeformReport& other) {
  thickened += other.thickened;
  enlarged += other.enlarged;
  reduced += other.reduced;
  not_finite += other.not_finite;
  return *this;
}

namespace {

double least_volume(const Particles& particles, std::span<const Material> materials, Eigen::Index p) {
  const auto material = static_cast<std::size_t>(particles.materials[static_cast<std::size_t>(p)]);
  return particles.masses[p] / materials[material].max_density();
}

/// Any shape and any flow.
void deform_one(const Matrix3d& map, std::span<const Material> materials, double cell_size, Eigen::Index p,
                Particles& particles, DeformReport& report) {
  Matrix3d shape = map * shape_matrix(particles, p) * map.transpose();
  if (!std::isfinite(shape.trace())) {  // no entry of a positive matrix is larger, and any NaN reaches it
    ++report.not_finite;
    return;
  }
  report.thickened += bound_axis_ratio(shape);
  const double least = least_volume(particles, materials, p);
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

/// m^2; volumes of shapes within it, and within its inverse, are finite.
constexpr double largest_trace = 1e100;

using MatrixLanes = std::array<std::array<Lanes, 3>, 3>;

SymmetricLanes mapped(const MatrixLanes& map, const SymmetricLanes& s) {
  const auto column = [&](std::size_t i, const Lanes& x, const Lanes& y, const Lanes& z) -> Lanes {
    return map[i][0] * x + map[i][1] * y + map[i][2] * z;
  };
  MatrixLanes half;  // map S
  for (std::size_t i = 0; i < 3; ++i)
    half[i] = {column(i, s[0], s[5], s[4]), column(i, s[5], s[1], s[3]), column(i, s[4], s[3], s[2])};
  const auto entry = [&](std::size_t i, std::size_t j) -> Lanes {
    return half[i][0] * map[j][0] + half[i][1] * map[j][1] + half[i][2] * map[j][2];
  };
  return {entry(0, 0), entry(1, 1), entry(2, 2), entry(1, 2), entry(2, 0), entry(0, 1)};
}

Lanes determinant(const SymmetricLanes& s) {
  return s[0] * (s[1] * s[2] - s[3] * s[3]) - s[5] * (s[5] * s[2] - s[3] * s[4]) +
         s[4] * (s[5] * s[3] - s[1] * s[4]);
}

/// Whether no semi-axis is thinner than the bound on their ratio allows, from shapes of trace 1: none is where S less its
/// trace / ratio^2 is positive definite, by its minors (Sylvester), since no eigenvalue exceeds the trace.
bool clearly_thick(SymmetricLanes s) {
  constexpr double least = 1.0 / (largest_axis_ratio * largest_axis_ratio), margin = 1e-13;
  for (std::size_t k = 0; k < 3; ++k) s[k] -= least;
  return s[0].min(s[0] * s[1] - s[5] * s[5]).min(determinant(s)).minCoeff() > margin;
}

/// As bound_axis_ratio, for shapes S = trace * unit; returns how many of the first `count` it raised.
Eigen::Index thicken(SymmetricLanes& unit, const Lanes& trace, int count, SymmetricLanes& shape) {
  if (clearly_thick(unit)) return 0;
  EigenLanes eigen = eigen_of(unit);
  const Lanes longest = eigen.values[0].max(eigen.values[1]).max(eigen.values[2]);
  const Lanes least = longest / (largest_axis_ratio * largest_axis_ratio);
  const Lanes smallest = eigen.values[0].min(eigen.values[1]).min(eigen.values[2]);
  const Lanes thin =
      ((least * (1.0 - round_off) - smallest) * 1e300).max(0.0).min(1.0);  // 1 where raised, or 0
  if (thin.maxCoeff() == 0.0) return 0;
  for (Lanes& value : eigen.values) value = value.max(least);
  const SymmetricLanes raised = matrix_of(eigen);
  for (std::size_t k = 0; k < 6; ++k) {
    const Lanes change = thin * (raised[k] - unit[k]);
    unit[k] += change;
    shape[k] += trace * change;
  }
  return static_cast<Eigen::Index>(thin.head(count).sum());
}

SymmetricLanes shapes_of(const Particles& particles, const LaneParticles& four) {
  SymmetricLanes shapes;
  for (int lane = 0; lane < lane_count; ++lane) {
    for (std::size_t k = 0; k < 6; ++k)
      shapes[k][lane] =
          particles.shapes(static_cast<Eigen::Index>(k), four.index[static_cast<std::size_t>(lane)]);
  }
  return shapes;
}

Matrix3d matrix_in(const MatrixLanes& matrices, int lane) {
  Matrix3d matrix;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = matrices[i][j][lane];
  }
  return matrix;
}

/// What a particle's shape is scaled by to keep its volume within its bounds.
double scale_within(double volume, double least, double most, DeformReport& report) {
  if (volume < least * (1.0 - round_off)) {
    ++report.enlarged;
    return std::pow(std::cbrt(least / volume), 2);
  }
  if (volume > most * (1.0 + round_off)) {
    ++report.reduced;
    return std::pow(std::cbrt(most / volume), 2);
  }
  return 1.0;
}

}  // namespace

void deform_four(const std::array<Lanes, 9>& gradient, double dt, std::span<const Material> materials,
                 double cell_size, const LaneParticles& four, Particles& particles, DeformReport& report) {
  MatrixLanes map;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) map[i][j] = dt * gradient[i + 3 * j] + (i == j ? 1.0 : 0.0);
  }
  SymmetricLanes shape = mapped(map, shapes_of(particles, four));
  const Lanes trace = shape[0] + shape[1] + shape[2];
  if (!(trace.minCoeff() > 1.0 / largest_trace && trace.maxCoeff() < largest_trace)) {
    for (int lane = 0; lane < four.count; ++lane)  // too large for a volume, or not finite
      deform_one(matrix_in(map, lane), materials, cell_size, four.index[static_cast<std::size_t>(lane)],
                 particles, report);
    return;
  }
  SymmetricLanes unit;  // of trace 1: the determinant itself overflows long before S does
  for (std::size_t k = 0; k < 6; ++k) unit[k] = shape[k] / trace;
  report.thickened += thicken(unit, trace, four.count, shape);
  const Lanes volume = unit_sphere * trace * trace.sqrt() * determinant(unit).sqrt();
  for (int lane = 0; lane < four.count; ++lane) {
    const Eigen::Index p = four.index[static_cast<std::size_t>(lane)];
    const double least = least_volume(particles, materials, p);
    const double most = std::max(least, cell_size * cell_size * cell_size);
    const double scale = scale_within(volume[lane], least, most, report);
    for (std::size_t k = 0; k < 6; ++k)
      particles.shapes(static_cast<Eigen::Index>(k), p) = scale * shape[k][lane];
  }
}

DeformReport deform(const Eigen::Matrix<double, 9, Eigen::Dynamic>& velocity_gradients, double dt,
                    std::span<const Material> materials, double cell_size, Particles& particles) {
  DeformReport report;
  const auto count = static_cast<int>(particles.count());
  for (int first = 0; first < count; first += lane_count) {
    LaneParticles four{{}, std::min(lane_count, count - first)};
    std::array<Lanes, 9> gradient;
    for (int lane = 0; lane < lane_count; ++lane) {
      const int p = four.index[static_cast<std::size_t>(lane)] = first + std::min(lane, four.count - 1);
      for (std::size_t k = 0; k < 9; ++k)
        gradient[k][lane] = velocity_gradients(static_cast<Eigen::Index>(k), p);
    }
    deform_four(gradient, dt, materials, cell_size, four, particles, report);
  }
  return report;
}

}  // namespace talus
