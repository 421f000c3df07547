// The friction problem of cone_projection.h on rows (grid/row_layout.h): the four passes of an iteration, each a few loops
// along x. Copies of a cell are told apart by the (y, z) corner they sit at, slot y + 2 z: which corner along x that is
// follows from the cell's parity (in even cells slots 0 and 3 sit at the lower one, 1 and 2 at the upper).
#pragma once

#include "continuum/stress/friction_copies.h"
#include "continuum/stress/friction_tractions.h"

namespace talus {

template <class Real>
class FrictionRows {
 public:
  /// Until the next call, the problem's shape and masses: inverse_mass (1/kg) of open faces and the null face, curvatures.
  /// `region` and `bodies` are referred to.
  void prepare(const ActiveRegion& region, const Field& inverse_mass, const BodyCoupling& bodies,
               const BallBlocks& balls);
  /// Radii, free velocity (m/s), free speeds of bodies, and the copies to start from, as FrictionOperator has them.
  void read(const BallBlocks& balls, const Field& free_velocity, const Field& free_speeds,
            const Eigen::ArrayXd& from, RowCopies<Real>& copies);
  void write(const RowCopies<Real>& copies, Eigen::ArrayXd& to) const {
    write_copies(*region_, layout_, copies, to);
  }
  void reset(RowCopies<Real>& copies) const { reset_copies(*region_, layout_, copies); }
  void reset(RowVelocity<Real>& velocity) const {
    talus::reset(layout_, velocity.faces);
    velocity.bodies = Field::Zero(bodies_->inverse_mass().size());
  }

  /// 1. e = D2^T v on edges and cells.
  void strain_of(const RowVelocity<Real>& velocity);
  /// sum over copies of r |e| + s . e, J.
  double duality_gap(const RowCopies<Real>& copies) const;
  /// 2. next = project(s + beta (s - before) - e / (L d)). first: slope e . (next - s), second: the squared length of the step
  /// from the extrapolated point, weighted by d.
  PassSums step(double lipschitz, Real beta, const RowCopies<Real>& now, const RowCopies<Real>& before,
                RowCopies<Real>& next) const;
  void project(RowCopies<Real>& copies) const;
  /// 3. Mean over the copies, on edges and cells.
  void stress_of(const RowCopies<Real>& copies);
  /// 4. v = v_0 + M^-1 D2 of the stress at hand. first: |v - ahead|^2_M, second: |ahead|^2_M.
  PassSums move_faces(const RowVelocity<Real>& ahead, RowVelocity<Real>& velocity) const;
  /// ahead = v + beta (v - before).
  void extrapolate(const RowVelocity<Real>& now, const RowVelocity<Real>& before, Real beta,
                   RowVelocity<Real>& ahead) const;

 private:
  struct Strains;
  void read_constants(const Field& inverse_mass, const BallBlocks& balls);
  Strains strains_of(const Row& row, int slot) const;
  void wrap_cells(std::vector<Real>& cells) const;
  PassSums move_bodies(const Field& ahead, Field& speeds) const;

  const ActiveRegion* region_ = nullptr;
  const BodyCoupling* bodies_ = nullptr;
  RowLayout layout_;
  FrictionTractions<Real> tractions_;
  RowField<Real> odd_;     // 1 in cells of odd parity, else 0
  RowField<Real> radius_;  // of a cell's copies
  std::array<RowField<Real>, copies_per_cell> curvature_;
  RowFields<Real> edge_share_;  // on inner edges the share of one copy, 0 elsewhere
  RowFields<Real> inverse_mass_, mass_, free_velocity_;
  RowFields<Real> edge_strain_, cell_strain_;
  RowStress<Real> stress_;
  Field free_speeds_, body_impulse_;
};

}  // namespace talus
