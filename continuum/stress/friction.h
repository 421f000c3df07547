// Friction stress inside the true cone, on copies (section 5 of method.md), and wall friction bounded by the wall-normal
// stress and the reaction impulse (section 4). All stresses are impulses, S = s dt h^2 (N s).
//
// A cell copy holds the five components of a symmetric trace-free tensor in an orthonormal basis, so that their
// Euclidean norm is ||S||_F:
//   (S_xx - S_zz) / sqrt 2,   sqrt(3/2) S_yy,   sqrt 2 S_yz,   sqrt 2 S_zx,   sqrt 2 S_xy
// A wall copy holds the two tangential tractions, and so does a contact copy, along the contact's tangents.
#pragma once

#include "continuum/grid/operators.h"
#include "continuum/qp/cone_projection.h"
#include "continuum/stress/body_coupling.h"

namespace talus {

inline constexpr int components_per_copy = 5;

/// Fill above which a cell counts as packed. With none, deposition noise opens holes (method.md, section 3).
inline constexpr double packed_fill = 0.9;

/// What confines the sand of each cell, in the units of `pressure` (cells + 1). An unpacked cell carries little or no
/// pressure, yet at the free surface the sand in it rests on the packed cells beside it: it is skin. Pressure rising
/// linearly from 0 at the surface, the skin's is half of theirs. Without it the skin slides freely where gravity is not
/// along the grid (a draining bed turned by 30 degrees came to rest 2 degrees lower), and piles creep. A cell that expands
/// by more than `loosening` (m/s over its width), by `velocity` on the open faces and the bodies' `speeds`, is sand that leaves, and is not held.
Field confining_pressure(const ActiveRegion& region, const Field& fill, const Field& pressure,
                         const Field& velocity, double loosening, const BodyCoupling& bodies = no_bodies(),
                         const Field& speeds = {});
inline constexpr double skin_share = 0.5;

class FrictionOperator {
 public:
  explicit FrictionOperator(const ActiveRegion& region);

  /// Mean over the copies: diagonal stress on cells, shear on edges.
  void stress_of(const Eigen::ArrayXd& copies, StressField& stress) const;
  /// impulse = K copies = D2 (mean over the copies).
  void apply(const Eigen::ArrayXd& copies, Field& impulse) const;
  /// strain = K^T velocity, per copy.
  void apply_transpose(const Field& velocity, Eigen::ArrayXd& strain) const;

  /// Blocks with the curvature filled in; radii are left to friction_radii. Bodies add to that of their contacts the largest
  /// that all of these have together, by the body's motion.
  BallBlocks blocks(const Field& inverse_mass, const BodyCoupling& bodies = no_bodies()) const;
  /// Share of the two diagonal components of each copy in a cell's stress along an axis.
  static Eigen::Vector2d diagonal_share(int axis);
  /// Sets components that have no edge to act on to zero, so that they do not use up strength.
  void clear_idle(Eigen::ArrayXd& copies) const;

 private:
  Eigen::Index wall_offset() const { return components_per_copy * copies_per_cell * region_.cell_count(); }
  /// f(value in the copies, edge) for each shear component of each cell copy.
  template <class Function>
  void for_each_shear(Function&& f) const;
  /// f(value, edge) for each component of each wall copy.
  template <class Function>
  void for_each_traction(Function&& f) const;

  const ActiveRegion& region_;
  std::vector<int> edge_of_shear_;  // per cell copy, three
  mutable StressField stress_;      // scratch of apply and apply_transpose
};

/// Yield radii: sqrt 2 mu P in cells, P being `confining` (confining_pressure), by what solids leave open of them;
/// mu_w (P - n.S.n + R) at walls, n.S.n from `copies` as they are, R the reaction impulse per wall face; at contacts a
/// quarter of that to each copy, without R, for there the sand's whole momentum is on faces that the pressure moves.
void set_friction_radii(const ActiveRegion& region, const FrictionOperator& friction,
                        const Field& cell_friction, const Field& confining, const Field& pressure,
                        const Eigen::ArrayXd& wall_reaction, const Eigen::ArrayXd& copies, BallBlocks& balls);

}  // namespace talus
