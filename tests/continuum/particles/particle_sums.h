// What particles hold together, with the motion v + C (x - x_p) that they carry over their ellipsoids; and the making of
// single particles.
#pragma once

#include <Eigen/Dense>

#include "continuum/particles/particles.h"

namespace talus::testing {

struct Sums {
  double mass = 0.0;                                             // kg
  Eigen::Vector3d first_moment = Eigen::Vector3d::Zero();        // sum m x, kg m
  Eigen::Matrix3d second_moment = Eigen::Matrix3d::Zero();       // sum m (S / 5 + x x^T), kg m^2
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();            // kg m/s
  Eigen::Matrix3d moment_of_velocity = Eigen::Matrix3d::Zero();  // sum m (v x^T + C S / 5), kg m^2/s
  double energy = 0.0;                                           // kinetic, J

  /// About the origin, kg m^2/s: the antisymmetric part of x v^T.
  Eigen::Vector3d angular_momentum() const {
    const Eigen::Matrix3d m = moment_of_velocity;
    return {m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1)};
  }
};

inline Sums sums_of(const Particles& particles) {
  Sums sums;
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    const double m = particles.masses[p];
    const Eigen::Vector3d x = particles.positions.col(p), v = particles.velocities.col(p);
    const Eigen::Matrix3d shape = shape_matrix(particles, p), gradient = gradient_matrix(particles, p);
    sums.mass += m;
    sums.first_moment += m * x;
    sums.second_moment += m * (shape / 5.0 + x * x.transpose());
    sums.momentum += m * v;
    sums.moment_of_velocity += m * (v * x.transpose() + gradient * shape / 5.0);
    sums.energy += 0.5 * m * (v.squaredNorm() + (gradient * shape * gradient.transpose()).trace() / 5.0);
  }
  return sums;
}

/// Largest difference between two sums, each relative to the size of the terms it is the sum of.
inline double relative_difference(const Sums& a, const Sums& b) {
  const double m = a.mass, length = std::sqrt(a.second_moment.trace() / m),
               speed = std::sqrt(2.0 * a.energy / m);
  double worst = std::abs(a.mass - b.mass) / m;
  const auto consider = [&](double difference, double scale) {
    if (difference > 0.0) worst = std::max(worst, difference / scale);
  };
  consider((a.first_moment - b.first_moment).norm(), m * length);
  consider((a.second_moment - b.second_moment).norm(), m * length * length);
  consider((a.momentum - b.momentum).norm(), m * speed);
  consider((a.moment_of_velocity - b.moment_of_velocity).norm(), m * length * speed);
  consider((a.angular_momentum() - b.angular_momentum()).norm(), m * length * speed);
  return worst;
}

/// At rest, of material 0; it carries a velocity gradient, of 0.
inline void add_particle(const Eigen::Vector3d& position, double mass, const Eigen::Matrix3d& shape,
                         Particles& particles) {
  const Eigen::Index p = particles.count();
  particles.resize(p + 1);
  if (!particles.has_gradients()) particles.gradients.setZero(9, p + 1);
  particles.positions.col(p) = position;
  particles.velocities.col(p).setZero();
  particles.masses[p] = mass;
  particles.materials[static_cast<std::size_t>(p)] = 0;
  set_shape_matrix(shape, particles, p);
  particles.gradients.col(p).setZero();
}

inline Eigen::Matrix3d ellipsoid(double a, double b, double c) {
  return Eigen::Vector3d(a * a, b * b, c * c).asDiagonal();
}

/// Bit for bit.
inline bool identical(const Particles& a, const Particles& b) {
  return a.count() == b.count() && a.positions == b.positions && a.velocities == b.velocities &&
         (a.masses == b.masses).all() && a.materials == b.materials && a.shapes == b.shapes &&
         a.gradients == b.gradients;
}

}  // namespace talus::testing
