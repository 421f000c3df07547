// What several tables of a scene file have alike.
#pragma once

#include <Eigen/Geometry>

#include "continuum/files/checked_table.h"
#include "continuum/grid/grid.h"

namespace talus {

inline constexpr double largest_friction_angle_deg = 60.0;

/// The friction coefficient of an angle in degrees.
double friction_of_angle_deg(double angle);

/// `friction_angle_deg`, or `rough = true` for what is as rough as the sand. Throws InputError.
double read_solid_friction(const CheckedTable& table);

/// Whether a box lies in the domain, but for round-off.
bool holds(const Grid& grid, const Eigen::AlignedBox3d& box);

}  // namespace talus
