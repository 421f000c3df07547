// Particles change shape with the flow (equation 5.42, section 8 of method.md):
//
//   S <- (I + dt L) S (I + dt L)^T,   L_ij = d v_i / d x_j at the particle,   volume = 4/3 pi sqrt(det S)
//
// and two bounds keep S the shape of some sand, whatever dt L is:
//   - no semi-axis is thinner than 1 / largest_axis_ratio of the longest: thinner ones are raised. It keeps S
//     positive definite and its inverse good to 1e-13; the longest particle that need not split (reshape.h) is then
//     no thinner than 1/43 of a cell, which is less than a grain in any case worth running.
//   - m / rho_max <= volume <= h^3, by scaling S as a whole. A particle heavier than a full cell keeps the lower bound.
#pragma once

#include <span>

#include "continuum/materials/material.h"
#include "continuum/particles/lanes.h"
#include "continuum/particles/particles.h"

namespace talus {

inline constexpr double largest_axis_ratio = 32.0;

/// 4/3 pi sqrt(det S), m^3; 0 where S is not positive definite by round-off.
double shape_volume(const Eigen::Matrix3d& shape);

/// How many particles met a bound.
struct DeformReport {
  Eigen::Index thickened = 0;   // a semi-axis was raised
  Eigen::Index enlarged = 0;    // to m / rho_max
  Eigen::Index reduced = 0;     // to h^3
  Eigen::Index not_finite = 0;  // S would not have been finite: left as it was

  DeformReport& operator+=(const DeformReport& other);
};

/// One step of 5.42. `velocity_gradients`: 9 x n, 1/s, column-major 3 x 3; dt in s; `cell_size` h in m.
DeformReport deform(const Eigen::Matrix<double, 9, Eigen::Dynamic>& velocity_gradients, double dt,
                    std::span<const Material> materials, double cell_size, Particles& particles);

/// The same for four particles; `gradient` by entry, and the report is added to.
void deform_four(const std::array<Lanes, 9>& gradient, double dt, std::span<const Material> materials,
                 double cell_size, const LaneParticles& four, Particles& particles, DeformReport& report);

}  // namespace talus
