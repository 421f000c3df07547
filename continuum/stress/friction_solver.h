// Solves the friction problem of a step: the method of cone_projection.h on rows (friction_rows.h).
#pragma once

#include "continuum/stress/friction_rows.h"

namespace talus {

/// Keeps its memory from step to step. A copy starts with none: nothing here but the Lipschitz constant has a bearing on
/// results, and that is copied.
class FrictionSolver {
 public:
  FrictionSolver() = default;
  /// Goes on where one of that Lipschitz constant was.
  explicit FrictionSolver(double lipschitz) : lipschitz_(lipschitz) {}
  FrictionSolver(const FrictionSolver& other) : lipschitz_(other.lipschitz_) {}
  FrictionSolver& operator=(const FrictionSolver& other) {
    if (this != &other) lipschitz_ = other.lipschitz_;
    return *this;
  }
  FrictionSolver(FrictionSolver&&) = default;
  FrictionSolver& operator=(FrictionSolver&&) = default;
  ~FrictionSolver() = default;

  /// Before the solves of a step; what it is given must outlive them. inverse_mass: of open faces and the null face, 1/kg.
  void prepare(const ActiveRegion& region, const Field& inverse_mass,
               const BodyCoupling& bodies = no_bodies());
  /// As project_onto_cone. `copies` enters as the warm start and leaves as the minimiser.
  ConeProjectionResult solve(const BallBlocks& balls, const Field& free_velocity,
                             const ConeProjectionSettings& settings, Eigen::ArrayXd& copies);
  /// The same with the bodies' free speeds (BodyCoupling::speeds).
  ConeProjectionResult solve(const BallBlocks& balls, const Field& free_velocity, const Field& free_speeds,
                             const ConeProjectionSettings& settings, Eigen::ArrayXd& copies);

  /// L of the last solve (cone_projection.h), 1 before the first.
  double lipschitz() const { return lipschitz_; }

 private:
  template <class Real>
  struct Memory {
    FrictionRows<Real> rows;
    RowCopies<Real> now, before, next;
    RowVelocity<Real> velocity, velocity_before, velocity_next, velocity_ahead;
    bool ready = false;
  };
  template <class Real, class Other>
  ConeProjectionResult solve(Memory<Real>& memory, Memory<Other>& unused, const BallBlocks& balls,
                             const Field& free_velocity, const Field& free_speeds,
                             const ConeProjectionSettings& settings, Eigen::ArrayXd& copies);

  const ActiveRegion* region_ = nullptr;
  const Field* inverse_mass_ = nullptr;
  const BodyCoupling* bodies_ = nullptr;
  Memory<float> single_precision_;
  Memory<double> double_precision_;
  double lipschitz_ = smallest_lipschitz;
};

}  // namespace talus
