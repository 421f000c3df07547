// How bodies take part in the solves of pressure and friction (method.md, section 10; 5.23 of the source): as velocities beside
// those of the faces, and with the transpose of what they do to the sand done to them.
//
//   V = B q        twist (velocity of the centre of mass, angular velocity) of a body; q the speeds of its modes, in
//                  sqrt(kg) m/s, each of mass 1, so that B B' = M^-1: six of a free body, one of a hinged one; six of
//                  infinite mass (and B = 1) where the motion is prescribed
//   compression of a cell    (D1^T v)_c + W . v_body          W: the area vector of the body's surface in the cell, into the
//                                                             sand, in h^2; - P W is the impulse that the body receives
//   slip at a contact        t . (v - v_body)
//   strain of a closure      - |n_a| n . (v - v_body)
//
// v_body is taken at the cell's centre. All that a contact does to the faces of its cell acts along lines through that
// centre: so the sand on the grid and the bodies together keep their momentum, and their angular momentum.
#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <span>
#include <vector>

#include "continuum/grid/operators.h"
#include "continuum/solids/body.h"

namespace talus {

/// One row of a matrix on the speeds of all modes: those of one body are not 0.
struct BodyRow {
  int first = 0, count = 0;  // the body's modes
  int body = -1;
  std::array<double, 6> values{};

  double times(const Field& speeds) const {
    double sum = 0.0;
    for (int k = 0; k < count; ++k) sum += values[static_cast<std::size_t>(k)] * speeds[first + k];
    return sum;
  }
  void add_to(Field& speeds, double factor) const {
    for (int k = 0; k < count; ++k) speeds[first + k] += factor * values[static_cast<std::size_t>(k)];
  }
};

class BodyCoupling {
 public:
  /// Without bodies.
  BodyCoupling() = default;
  /// As they stand; the region's contacts and closures tell by number which of `bodies` they touch.
  BodyCoupling(const ActiveRegion& region, std::span<const Body> bodies);

  bool any() const { return inverse_mass_.size() > 0; }
  /// 1/mass of each mode: 1, or 0 where the motion is prescribed.
  const Field& inverse_mass() const { return inverse_mass_; }
  /// q of the bodies' twists, and back.
  Field speeds(std::span<const Twist> twists) const;
  std::vector<Twist> twists(const Field& speeds) const;

  /// cells (compression, cells + 1) += W . v_body.
  void add_compression(const Field& speeds, Field& cells) const;
  /// speeds += factor * M^-1 K P: what pressure impulses P (cells + 1) do; factor -1 is theirs.
  void add_pressure(const Field& pressure, double factor, Field& speeds) const;
  /// strain (slips of contacts, and diagonals of cells with a closure) += what the bodies' motion adds.
  void add_strain(const Field& speeds, StressField& strain) const;
  /// speeds += M^-1 times the impulses of the tractions at contacts and of the stress at closures.
  void add_friction(const StressField& stress, Field& speeds) const;

  /// Compression rows: the cell of each, and the row.
  struct Cell {
    int cell;
    BodyRow row;
  };
  const std::vector<Cell>& cells() const { return cells_; }
  /// Slip rows, two a contact, along its tangents; and one a closure. Empty rows where the wall is fixed.
  const std::vector<BodyRow>& contact_rows() const { return contact_rows_; }
  const std::vector<BodyRow>& closure_rows() const { return closure_rows_; }

  /// Of each body, the largest second derivative of the kinetic energy by all tractions at its contacts, 1/kg.
  std::vector<double> friction_curvature() const;

  /// U, cells x modes, with U_cm the compression by mode m where it can be moved, else 0: A gains U U'.
  Eigen::SparseMatrix<double> pressure_modes() const;

 private:
  struct Modes {
    int first, count;
    Eigen::Matrix<double, 6, 6> to_twist, to_speeds;  // its first `count` columns, rows; the others are 0
  };
  /// `arm`: from the centre of mass, m.
  BodyRow row(int body, const Eigen::Vector3d& arm, const Eigen::Vector3d& direction) const;

  std::vector<Modes> bodies_;
  Field inverse_mass_;
  Eigen::Index cell_count_ = 0;
  std::vector<Cell> cells_;
  std::vector<BodyRow> contact_rows_, closure_rows_;
  std::vector<std::pair<int, int>> closures_;  // cell and axis
};

/// Impulse (N s), and angular impulse about the centre of mass (N m s), that the sand gives to each body.
struct BodyImpulse {
  Eigen::Vector3d linear = Eigen::Vector3d::Zero(), angular = Eigen::Vector3d::Zero();
};
std::vector<BodyImpulse> impulses_on_bodies(const ActiveRegion& region, std::span<const Body> bodies,
                                            const Field& pressure, const StressField& friction);

/// A coupling with none, which outlives all solvers.
const BodyCoupling& no_bodies();

}  // namespace talus
