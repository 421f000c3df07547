// The seeded loose packings that the shear cell starts from, the same to both codes to the last bit.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "dem_cases/shear_cell/shear_cell.h"

namespace talus::dem {

/// Columns are spheres: the lower wall's, the upper wall's, then the free ones on a jittered lattice, with small
/// random velocities. No free sphere touches another.
struct ShearStart {
  std::uint64_t seed;
  Eigen::Vector3d size;         // m, of the periodic cell; with walls, z is the distance between their planes
  Eigen::Index wall_count;      // spheres in each of the two walls; 0 without walls
  Eigen::Matrix3Xd positions;   // m
  Eigen::Matrix3Xd velocities;  // m/s
  Eigen::VectorXd radii;        // m

  Eigen::Index count() const { return radii.size(); }
  double free_volume() const;  // m^3, solid, of the free spheres
};

/// Fully periodic, for the biaxial test.
ShearStart make_periodic_start(const ShearCell& cell, std::uint64_t seed);

/// Between two walls at z = 0 and z = size.z(), each a square layer of spheres of the mean diameter about a diameter
/// apart, in turn 0.4 diameters above and below its plane, so that the flow does not slide along them.
ShearStart make_walled_start(const ShearCell& cell, std::uint64_t seed);

}  // namespace talus::dem
