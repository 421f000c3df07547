// Eigenvalues and eigenvectors of four symmetric 3 x 3 matrices at once, by Jacobi's rotations.
#pragma once

#include "continuum/particles/lanes.h"

namespace talus {

/// Entries in the order of Particles::shapes: S_xx, S_yy, S_zz, S_yz, S_zx, S_xy.
using SymmetricLanes = std::array<Lanes, 6>;

struct EigenLanes {
  std::array<Lanes, 3> values;                  // in no order
  std::array<std::array<Lanes, 3>, 3> vectors;  // vectors[k] is the unit vector of values[k]
};

/// To round-off of the largest eigenvalue, which must be near 1: finite matrices scaled to trace 1, say.
EigenLanes eigen_of(const SymmetricLanes& matrix);

/// sum over k of values[k] vectors[k] vectors[k]^T.
SymmetricLanes matrix_of(const EigenLanes& eigen);

}  // namespace talus
