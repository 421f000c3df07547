// D1, D2 and their transposes on the staggered grid (section 2 of method.md), matrix-free, as gathers over the active
// region's tables. All are differences without the factor 1/h: pressures and stresses enter as impulses
// P = p dt h^2 (N s through one face), so that a face's velocity changes by their difference over its mass.
//
//   D1:   cells -> faces    (D1 P)_f   = a_f (P_above - P_below), a_f the open share of the face
//   D1^T: faces -> cells    (D1^T v)_c = -(sum over axes of a_upper v_upper - a_lower v_lower) = -h div v
//   D2:   stress -> faces   (D2 S)_f   = difference of S_aa across the face + differences of the two shears along it
//   D2^T: faces -> stress   minus the symmetric gradient; a shear S_bc stands for both S_bc and S_cb
// A closure (active_region.h) replaces the normal strain beside a face that a solid closes, in D2 and D2^T alike.
//
// Fields have the sizes of the region's counts plus the null entry, which is read as 0 and never written.
#pragma once

#include <Eigen/Core>

#include "continuum/grid/active_region.h"

namespace talus {

using Field = Eigen::ArrayXd;

/// Stress (or its conjugate, strain) on the grid: diagonal on cells, shear on edges, and at contacts with solids the
/// tractions on the sand along the contact's tangents (or their conjugate, the slip velocity).
struct StressField {
  Eigen::Array3Xd diagonal;  // 3 x (cells + 1)
  Field shear;               // edges + 1
  Field contact;             // values_per_contact each
};

StressField make_stress_field(const ActiveRegion& region);

/// faces += factor * D1 cells.
void add_gradient(const ActiveRegion& region, const Field& cells, double factor, Field& faces);
/// cells = D1^T faces.
void gradient_transpose(const ActiveRegion& region, const Field& faces, Field& cells);
/// faces += D2 stress.
void add_stress_divergence(const ActiveRegion& region, const StressField& stress, Field& faces);
/// strain = D2^T faces.
void stress_divergence_transpose(const ActiveRegion& region, const Field& faces, StressField& strain);

}  // namespace talus
