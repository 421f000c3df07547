// Continuum fields of a set of grains on a grid (Goldhirsch 2010; Weinhart, Thornton, Luding & Bokhove 2012), with the kernel W
// of kernel.h; r a cell centre, sums over grains i and contacts c:
//
//   volume fraction   phi(r)   = sum V_i W(r - r_i)
//   density           rho(r)   = sum m_i W(r - r_i)
//   velocity          v(r)     = sum m_i v_i W(r - r_i) / rho(r)
//   kinetic stress    sigma_k  = - sum m_i v_i' v_i'^T W(r - r_i),      v_i' = v_i - v(r)
//   contact stress    sigma_c  = - sum f_c b_c^T  int_0^1 W(r - r_i + s b_c) ds
//
// f_c is the force on grain i, b_c the branch from the other end to r_i. Stress is negative in compression: sigma = -p I + s.
// The other end is the centre of the other grain or, at a wall or a fixed body, the point of contact: so the boundary's force
// enters the stress (Weinhart 2012), and as the kernel is folded at the wall, nothing of it is lost behind.
//
// Sums over the grid times the cell volume are those over the grains to round-off: solid volume, mass, momentum, sum f b^T.
// Where the velocity has a gradient within W, the kinetic stress holds that too, of the order rho (gradient x width)^2.
// The integral along the branch: branch_quadrature.h.
//
// Known limits: walls are the grid's own outer faces (not slopes or bodies within), boxes are orthogonal (no Lees-Edwards
// shift), and periodic lengths are over twice the longest branch.
#pragma once

#include <Eigen/Core>
#include <span>

#include "analysis/coarse_graining/coarse_grid.h"
#include "analysis/coarse_graining/kernel.h"
#include "analysis/snapshot.h"

namespace talus::analysis {

/// Each pair of grains once; which of the two is `centre` does not matter.
struct GrainContact {
  Eigen::Vector3d centre;  // m, of the grain that the force acts on
  Eigen::Vector3d other;   // m, centre of the other grain, or the point of contact with a wall or fixed body
  Eigen::Vector3d force;   // N, on the grain at `centre`
};

/// One column for each cell.
struct CoarseFields {
  using Tensors =
      Eigen::Matrix<double, 9, Eigen::Dynamic>;  // each column a 3 x 3 matrix, first index fastest

  Eigen::VectorXd volume_fraction;    // 1
  Eigen::VectorXd density;            // kg/m^3
  Eigen::Matrix3Xd momentum_density;  // kg/(m^2 s)
  Eigen::Matrix3Xd velocity;          // m/s; NaN where there is no mass
  Tensors kinetic_stress;             // Pa; zero where there is no mass
  Tensors contact_stress;             // Pa; not symmetric where contacts carry moments

  /// Kinetic and contact stress of one cell.
  Eigen::Matrix3d stress(Eigen::Index cell) const;
};

/// `grain_density` is that of the solid, kg/m^3. Throws std::invalid_argument for a broken grid, kernel or density; SnapshotError
/// when an item lies outside the walls or anything of a contact is not finite.
CoarseFields coarse_grain(const Snapshot& snapshot, double grain_density,
                          std::span<const GrainContact> contacts, const CoarseGrid& grid,
                          const Kernel& kernel);

}  // namespace talus::analysis
