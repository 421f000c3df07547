// The tables [[body]] of a scene.
#pragma once

#include <vector>

#include "continuum/files/checked_table.h"
#include "continuum/solids/body.h"
#include "continuum/solids/contact_points.h"

namespace talus {

/// Keys of a [[body]]:
///
///   name                   letters, digits, - and _; no two alike
///   shape                  as read_shape has it, where the body is at the start; not a plane, not hollow
///   density_kg_m3
///   friction_angle_deg     against sand; or rough = true
///   contact_friction       coefficient against bodies and walls; 0.5 unless given
///   restitution            the same, 0 to 1; 0 unless given
///   velocity_m_s, angular_velocity_rad_s   at the start; 0 unless given
///   motion                 { kind = "free" } unless given, or
///                          { kind = "hinge", pivot_m, axis, torque_n_m = 0 }: starts with angular_velocity_rad_s, along its axis
///                          { kind = "prescribed", velocity_m_s = 0, angular_velocity_rad_s = 0, start_s = 0, end_s = infinity }
///
/// Throws InputError, also for bodies that reach out of the domain or are longer than a period, lie in walls or in each other
/// (what is prescribed may lie in walls), or are thinner than a quarter of a cell.
std::vector<Body> read_bodies(const CheckedTable& root, const BodySurroundings& surroundings);

}  // namespace talus
