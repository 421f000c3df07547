// Friction stress inside the true cone, on copies (section 5 of method.md), and wall friction bounded by the wall-normal
// stress and the reaction impulse (section 4). All stresses are impulses, S = s dt h^2 (N s).
//
// A cell copy holds the five components of a symmetric trace-free tensor in an orthonormal basis, so that their
// Euclidean norm is ||S||_F:
//   (S_xx - S_zz) / sqrt 2,   sqrt(3/2) S_yy,   sqrt 2 S_yz,   sqrt 2 S_zx,   sqrt 2 S_xy
// A wall copy holds the two tangential tractions.
#pragma once

#include "continuum/grid/operators.h"
#include "continuum/qp/cone_projection.h"

namespace talus {

inline constexpr int components_per_copy = 5;

class FrictionOperator {
 public:
  explicit FrictionOperator(const ActiveRegion& region);

  /// Mean over the copies: diagonal stress on cells, shear on edges.
  void stress_of(const Eigen::ArrayXd& copies, StressField& stress) const;
  /// impulse = K copies = D2 (mean over the copies).
  void apply(const Eigen::ArrayXd& copies, Field& impulse) const;
  /// strain = K^T velocity, per copy.
  void apply_transpose(const Field& velocity, Eigen::ArrayXd& strain) const;

  /// Blocks with the curvature filled in; radii are left to friction_radii.
  BallBlocks blocks(const Field& inverse_mass) const;
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

/// Yield radii: sqrt 2 mu P in cells; mu_w (P - n.S.n + R) at walls, n.S.n from `copies` as they are, R the
/// reaction impulse per wall face.
void set_friction_radii(const ActiveRegion& region, const FrictionOperator& friction,
                        const Field& cell_friction, const Field& pressure,
                        const Eigen::ArrayXd& wall_reaction, const Eigen::ArrayXd& copies, BallBlocks& balls);

}  // namespace talus
