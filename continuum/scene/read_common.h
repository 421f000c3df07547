// What several tables of a scene file have alike.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "continuum/files/checked_table.h"
#include "continuum/grid/grid.h"

namespace talus {

inline constexpr double largest_friction_angle_deg = 60.0;

// Far beyond any flow of grains, and far from where squares and cubes of numbers overflow or vanish.
inline constexpr Range coordinate_range{-1e6, 1e6};    // m
inline constexpr Range length_range{1e-9, 1e6};        // m
inline constexpr Range non_negative_length{0.0, 1e6};  // m
inline constexpr Range velocity_range{-1e4, 1e4};      // m/s
inline constexpr Range rotation_range{-1e5, 1e5};      // rad/s
inline constexpr Range acceleration_range{-1e4, 1e4};  // m/s^2
inline constexpr Range time_range{1e-9, 1e9};          // s
inline constexpr Range solid_density_range{1.0, 3e4};  // kg/m^3: from foam to osmium
inline constexpr Range torque_range{-1e12, 1e12};      // N m

/// No more of each kind of table: each cell is held against every wall, each body against every other.
inline constexpr std::size_t most_tables = 1000;
/// The tables [[key]] of a file, none where there is none. Throws InputError for more than most_tables.
std::vector<CheckedTable> up_to_most_tables(const CheckedTable& root, std::string_view key);

/// The friction coefficient of an angle in degrees.
double friction_of_angle_deg(double angle);

/// `friction_angle_deg`, or `rough = true` for what is as rough as the sand. Throws InputError.
double read_solid_friction(const CheckedTable& table);

/// Whether a box lies in the domain, but for round-off.
bool holds(const Grid& grid, const Eigen::AlignedBox3d& box);

}  // namespace talus
