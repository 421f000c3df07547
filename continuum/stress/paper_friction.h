// The friction problem of the source, one component of the stress at a time (section 5.5.1; 5.44-5.46, 5.49-5.50).
//
//   minimise E(S) = 1/2 sum_f M_f u_f^2,   u = u_0 + M^-1 D2 S,   over the box |S_ij| <= alpha P, S trace-free
//   u = phi v the flux, M^-1 = (phi/rho) / (h^3 k), S = s dt h^2 the impulse:   A2 = D2^T M^-1 D2,   b2 = D2^T u_0
//
// in the order of the source, earlier components held at their new values. With up, next and last for its y, z and x:
//   1. S_up,up                     on each column of cells along up, a problem of its own
//   2. S_last,last and S_next,next together: one unknown a cell, S_last,last = x, S_next,next = -S_up,up - x
//   3. S_last,up; S_up,next; S_next,last: the edges along next, last, up
//   4. the traction of solids that cut cells (contacts): both tangents of every copy at once, each within its own bound
//
// Step 1 alone leaves a trace, which step 2 takes out again: there the energy can rise above what step 1 left.
//
// alpha = sqrt(2/3) mu. The source has alpha = sqrt(2/3) sin(theta), and sqrt(3) alpha p = sqrt(2) mu p (method.md, section
// 1): its sin(theta) is the mu of our cone, whatever angle the material was calibrated by.
#pragma once

#include <optional>

#include "continuum/grid/operators.h"
#include "continuum/qp/problem.h"

namespace talus {

/// Half-widths of the box, N s. An empty cell counts as one without pressure. Diagonal: alpha P of the cell. Inner edge:
/// mean of alpha P over the four cells around it. Wall edge: mean of mu_w P over the two cells beside it, P being the
/// pressure: neither the stress normal to the wall nor the impulse that the wall takes up itself. Contact: each copy's
/// share of mu_w P over the wall's area in the cell.
struct FrictionBox {
  Field cell;     // cells + 1
  Field edge;     // edges + 1
  Field contact;  // two per contact copy
};
FrictionBox friction_box(const ActiveRegion& region, const Field& cell_friction, const Field& pressure);

/// The axis that stands for the source's y: the one gravity points along most; z without gravity.
int up_axis(const Eigen::Vector3d& gravity);

/// Solves for the components of `stress` in turn. Each solve takes the component's value as warm start, leaves its
/// minimiser there, and reports the largest component of the projected gradient, m/s; tolerances are in m/s.
class PaperFriction {
 public:
  /// `inverse_mass`, 1/kg: open_faces + 1 entries, kept by reference. `record`, unless empty, is given each problem
  /// before it is solved; the columns of step 1 as one, for they do not touch.
  PaperFriction(const ActiveRegion& region, const Field& inverse_mass, int up, ProblemRecorder record = {});

  /// The strain that the motion of bodies adds from now on; at first there is none.
  void move_bodies(StressField strain) { of_bodies_ = std::move(strain); }

  /// All components once, in the order above, the largest residual and the sum of the iterations over them;
  /// `unconverged` counts those that hit their cap. `frictionless` is u_0, m/s.
  struct Result {
    int iterations = 0;
    int unconverged = 0;
    double residual = 0.0;
  };
  Result solve(const Field& frictionless, const FrictionBox& box, const BoundQpSettings& settings,
               StressField& stress) const;

  /// Step 1; where up is a periodic axis, or a solid closes faces along it, columns have no ends or
  /// touch, and are solved as by solve_up. Iterations are those of the
  /// slowest column.
  BoundQpResult solve_columns(const Field& frictionless, const FrictionBox& box,
                              const BoundQpSettings& settings, StressField& stress) const;
  /// Step 1, all columns as one problem.
  BoundQpResult solve_up(const Field& frictionless, const FrictionBox& box, const BoundQpSettings& settings,
                         StressField& stress) const;
  /// Step 2.
  BoundQpResult solve_pair(const Field& frictionless, const FrictionBox& box, const BoundQpSettings& settings,
                           StressField& stress) const;
  /// Step 3, for the edges along `axis`.
  BoundQpResult solve_shear(int axis, const Field& frictionless, const FrictionBox& box,
                            const BoundQpSettings& settings, StressField& stress) const;

  /// Step 4.
  BoundQpResult solve_contacts(const Field& frictionless, const FrictionBox& box,
                               const BoundQpSettings& settings, StressField& stress) const;

  /// u = u_0 + M^-1 D2 S.
  Field flux(const Field& frictionless, const StressField& stress) const;

 private:
  /// Cells of one column along up, from below, as one tridiagonal matrix.
  struct Column {
    std::vector<int> cells;
    Eigen::ArrayXd below, diagonal, above;
  };
  std::vector<Column> make_columns() const;
  /// D2^T u, with what bodies add.
  StressField strain(const Field& flux) const;
  /// Minimises over one component, x, with the rest of the stress as it is.
  template <class Component, class Variables>
  BoundQpResult minimise(const char* name, const Component& component, const Variables& variables,
                         const Field& rest, const BoundQpSettings& settings, Field& x) const;

  const ActiveRegion& region_;
  const Field& inverse_mass_;
  int up_;
  ProblemRecorder record_;
  std::optional<StressField> of_bodies_;
  std::vector<Column> columns_;
};

}  // namespace talus
