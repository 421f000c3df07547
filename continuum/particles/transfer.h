// Particles <-> grid with the trilinear kernel.
//
// Weights that fall on a face or cell which is not in use (inside a wall, or beyond the free surface) are kept on the
// particle's own cell (grid/stencil.h). So weights sum to one, but for cells that solids close on both sides along
// an axis: the grid holds exactly the particles' mass, momentum and volume, and what a face's velocity gains the particles gain. (Section 4 of method.md asks this for walls;
// carrying it to the free surface makes a layer's friction right without extrapolating velocities.) Fill is divided by
// what solids leave open of the cell's kernel.
//
// Particles lie in active cells; std::invalid_argument is thrown otherwise. Where a function takes them by cell, `points` are
// their positions sorted (grid/points_by_cell.h); the others sort for themselves. Results are the same for any number of
// threads, bit for bit: what deposits on one face does so in one order.
#pragma once

#include <span>

#include "continuum/grid/active_region.h"
#include "continuum/grid/operators.h"
#include "continuum/materials/material.h"
#include "continuum/particles/particles.h"

namespace talus {

/// Face fields here have face_count() entries: open faces, null, wall faces.
struct GridState {
  Field fill;         // cells + 1: phi = deposited minimum volume / cell volume
  Field friction;     // cells + 1: mu, mean over the deposited volume
  Field face_mass;    // kg
  Field face_volume;  // m^3, minimum volume m / rho_max
  Field velocity;     // v^n, m/s
};

/// m / rho_max of each particle, m^3.
Eigen::ArrayXd minimum_volumes(const Particles& particles, std::span<const Material> materials);

/// `friction`: mu of each particle.
GridState deposit(const ActiveRegion& region, const PointsByCell& points, const Particles& particles,
                  std::span<const Material> materials, const Eigen::ArrayXd& friction);
GridState deposit(const ActiveRegion& region, const Particles& particles, std::span<const Material> materials,
                  const Eigen::ArrayXd& friction);

/// For the density correction. In its fill, weights beyond the free surface are lost, so that it never exceeds 1
/// merely because particles lie close to the edge of their cell.
struct DepositedVolume {
  Field fill;   // cells + 1
  Field faces;  // as GridState::face_volume
};
DepositedVolume deposit_volume(const ActiveRegion& region, const PointsByCell& points,
                               const Particles& particles, std::span<const Material> materials);
Field deposit_fill(const ActiveRegion& region, const Particles& particles,
                   std::span<const Material> materials);

/// The face field interpolated to each particle, 3 x n.
Eigen::Matrix3Xd interpolate(const ActiveRegion& region, const PointsByCell& points, const Field& faces,
                             const Eigen::Matrix3Xd& positions);
Eigen::Matrix3Xd interpolate(const ActiveRegion& region, const Field& faces,
                             const Eigen::Matrix3Xd& positions);

/// The derivative of `interpolate` with respect to position, d v_i / d x_j, 1/s: 9 x n, column-major 3 x 3. Exact inside
/// a half cell; on the planes between, where it jumps, the value of the upper side. Weights that are redirected take
/// their derivative along, so that it is 0 across a wall or a free surface to which the velocity is carried on.
Eigen::Matrix<double, 9, Eigen::Dynamic> interpolate_gradient(const ActiveRegion& region, const Field& faces,
                                                              const Eigen::Matrix3Xd& positions);

}  // namespace talus
