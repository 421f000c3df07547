// The shape of a solid, as a scene file gives it: shape = { kind = "sphere", centre_m = [0, 0, 0.1], radius_m = 0.05 }.
#pragma once

#include "continuum/files/checked_table.h"
#include "continuum/solids/shape.h"

namespace talus {

/// Reads all of `table`; lengths in m, angles in degrees. Directions need not be of unit length.
///
///   kind       keys
///   plane      point_m, normal: out of the solid
///   box        lower_m, upper_m; optional rotation_axis and rotation_angle_deg: turned about its centre
///   sphere     centre_m, radius_m
///   capsule    from_m, to_m: ends of its axis, radius_m: of the tube about it and of its round ends
///   cylinder   base_m: centre of its lower end, axis: upwards, radius_m, height_m
///   cone       base_m, axis, base_radius_m, top_radius_m: one of them may be 0, height_m
///   hourglass  base_m, axis, bulb_radius_m, bulb_height_m: the cylindrical part of each bulb, neck_radius_m,
///              neck_length_m, cone_half_angle_deg: between cone and axis
///   profile    base_m, axis, points_m = [[r, z], ...]: corners of the polygon that is turned about the axis
///   mesh       file: .stl or .obj, beside the scene file or absolute; optional scale and offset_m
///
/// All but the plane take hollow = true: the solid is then all the space around the shape.
/// Throws InputError naming file, line, key, value and what is allowed, also for keys that do not belong.
Shape read_shape(const CheckedTable& table);

}  // namespace talus
