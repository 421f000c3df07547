// The continuum's material points, as a structure of arrays.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <vector>

namespace talus {

/// One column per particle everywhere, but for gradients. Arrays always agree in length; use the members below to change it.
struct Particles {
  Eigen::Matrix3Xd positions;   // m
  Eigen::Matrix3Xd velocities;  // m/s
  Eigen::ArrayXd masses;        // kg
  std::vector<int> materials;   // index into the scene's materials
  /// Ellipsoid { x : x'S^-1 x <= 1 } about the position: S_xx, S_yy, S_zz, S_yz, S_zx, S_xy, m^2. A particle is
  /// uniform in it, so its second moment about its centre is m S / 5.
  Eigen::Matrix<double, 6, Eigen::Dynamic> shapes;
  /// Velocity gradient d v_i / d x_j carried by a particle (APIC), 1/s, column-major 3 x 3. With FLIP there are no columns,
  /// which stands for zero.
  Eigen::Matrix<double, 9, Eigen::Dynamic> gradients;
  /// The particles that each one was made of, by the numbers they had when track_origins was called; -1 for none. Sorting and
  /// removal carry them along, children have their parent's, what a merge makes has those of both (none twice), what a source
  /// sends has none. Without columns nothing is tracked.
  Eigen::Matrix<int, 2, Eigen::Dynamic> origins;

  Eigen::Index count() const { return masses.size(); }
  bool has_gradients() const { return gradients.cols() > 0; }
  bool has_origins() const { return origins.cols() > 0; }

  /// From here on, until origins are emptied. Two suffice for a step: a particle merges at most once in it.
  void track_origins() {
    origins.resize(2, count());
    for (Eigen::Index p = 0; p < count(); ++p) origins.col(p) << static_cast<int>(p), -1;
  }

  /// Keeps the first n, or adds particles whose values are still to be set.
  void resize(Eigen::Index n) {
    positions.conservativeResize(3, n);
    velocities.conservativeResize(3, n);
    masses.conservativeResize(n);
    materials.resize(static_cast<std::size_t>(n));
    shapes.conservativeResize(6, n);
    if (has_gradients()) gradients.conservativeResize(9, n);
    if (has_origins()) origins.conservativeResize(2, n);
  }
  /// Overwrites particle `to` with particle `from`.
  void copy(Eigen::Index from, Eigen::Index to) {
    positions.col(to) = positions.col(from);
    velocities.col(to) = velocities.col(from);
    masses[to] = masses[from];
    materials[static_cast<std::size_t>(to)] = materials[static_cast<std::size_t>(from)];
    shapes.col(to) = shapes.col(from);
    if (has_gradients()) gradients.col(to) = gradients.col(from);
    if (has_origins()) origins.col(to) = origins.col(from);
  }
};

/// The velocity gradient that a particle carries, 1/s.
inline Eigen::Matrix3d gradient_matrix(const Particles& particles, Eigen::Index p) {
  if (!particles.has_gradients()) return Eigen::Matrix3d::Zero();
  return particles.gradients.col(p).reshaped<Eigen::ColMajor>(3, 3);
}

inline Eigen::Matrix3d shape_matrix(const Particles& particles, Eigen::Index p) {
  const auto s = particles.shapes.col(p);
  Eigen::Matrix3d m;
  m << s[0], s[5], s[4], s[5], s[1], s[3], s[4], s[3], s[2];
  return m;
}

/// The shape matrix of a sphere, m^2.
inline Eigen::Matrix3d sphere_of_volume(double volume) {
  return std::pow(0.75 * volume / std::numbers::pi, 2.0 / 3.0) * Eigen::Matrix3d::Identity();
}

inline void set_shape_matrix(const Eigen::Matrix3d& s, Particles& particles, Eigen::Index p) {
  particles.shapes.col(p) << s(0, 0), s(1, 1), s(2, 2), s(1, 2), s(2, 0), s(0, 1);
}

}  // namespace talus
