// Tractions at walls and at contacts with solids, and closures (grid/active_region.h): the part of the friction problem that
// is not regular, as lists beside the rows.
#pragma once

#include "continuum/stress/body_coupling.h"
#include "continuum/stress/friction_fields.h"

namespace talus {

template <class Real>
class FrictionTractions {
 public:
  void prepare(const ActiveRegion& region, const RowLayout& layout, const BodyCoupling& bodies,
               const BallBlocks& balls);
  void set_radii(const BallBlocks& balls);

  /// Slip velocities of all copies; puts the strain of closures over that of their cells.
  void strain_of(const RowVelocity<Real>& velocity, RowFields<Real>& cell_strain);
  /// One projected step from the extrapolated point. first: slope, second: squared length by curvature.
  PassSums step(double lipschitz, Real beta, const RowCopies<Real>& now, const RowCopies<Real>& before,
                RowCopies<Real>& next) const;
  void project(RowCopies<Real>& copies) const;
  double duality_gap(const RowCopies<Real>& copies) const;
  /// Shear stress on wall edges; pushes of contacts and closures on faces, whose diagonal stress is taken out, and on the modes
  /// of bodies.
  void add_stress(const RowCopies<Real>& copies, RowStress<Real>& stress, Field& body_impulse) const;

 private:
  struct WallEdge {
    int axis;                        // that the edge runs along
    int node;                        // of the edge
    std::array<int, 4> face_nodes;   // as ActiveRegion::edge_faces
    std::array<int, 4> wall_values;  // that act on it; -1 where none
  };
  /// Copies of two tractions each.
  struct Balls {
    std::vector<Real> radius, curvature, strain;
  };
  int node_of_face(int face) const { return layout_->node_of_face[static_cast<std::size_t>(face)]; }
  static PassSums step(const Balls& balls, double lipschitz, Real beta, const std::vector<Real>& now,
                       const std::vector<Real>& before, std::vector<Real>& next);

  const ActiveRegion* region_ = nullptr;
  const RowLayout* layout_ = nullptr;
  const BodyCoupling* bodies_ = nullptr;
  std::vector<WallEdge> wall_edges_;
  std::vector<int> edge_of_wall_value_;  // in wall_edges_; -1 where there is none
  std::vector<Real> wall_edge_strain_;
  std::vector<int> listed_;  // scratch: where an edge is in wall_edges_
  Balls walls_, contacts_;
};

}  // namespace talus
