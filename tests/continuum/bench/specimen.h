// What kernels are timed on: a box of sand in the middle of a larger domain with a rough floor, a few steps after it was let go.
#pragma once

#include "continuum/particles/sort.h"
#include "tests/continuum/qp/collapse_problems.h"

namespace talus::bench {

struct Specimen {
  State state;  // particles sorted by cell
  PointsByCell points;
  testing::CollapseMoment moment;
  Eigen::ArrayXd friction;  // mu of each particle
  Field inverse_mass;       // open faces + null, 1/kg
  Field velocity;           // v* of all faces, m/s

  const ActiveRegion& region() const { return moment.region; }
};

/// 4096 cells of sand times `size` (1, 2, 4, 8), 8 jittered particles a cell, velocities of a few cm/s at random.
/// Made once for each size.
const Specimen& specimen(int size);

}  // namespace talus::bench
