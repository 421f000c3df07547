// One seeded start for both discrete codes: the same spheres, to the last bit.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "dem_cases/case.h"

namespace talus::dem {

/// Columns are spheres. The first `fixed_count` are the floor's and never move; the others start as a loose
/// jittered lattice within the case's container, with small random velocities, and settle under gravity in each code.
struct Packing {
  std::uint64_t seed;
  Eigen::Index fixed_count;
  Eigen::Matrix3Xd positions;   // m
  Eigen::Matrix3Xd velocities;  // m/s, zero for fixed grains
  Eigen::VectorXd radii;        // m

  Eigen::Index count() const { return radii.size(); }
  Eigen::Index mobile_count() const { return count() - fixed_count; }
  double mobile_volume() const;  // m^3, solid
  double top() const;            // m, the highest point of any sphere
};

/// No two spheres overlap, but for neighbours that are both fixed, and none crosses a wall. The same case and
/// seed give the same spheres on every machine. Throws InputError when the case leaves no room.
Packing make_packing(const Case& a_case, std::uint64_t seed);

}  // namespace talus::dem
