// How fast and how long the shear cell is sheared, counted in steps of the discrete codes.
#pragma once

#include <cmath>
#include <cstdint>

#include "dem_cases/shear_cell/shear_cell.h"

namespace talus::dem {

/// I = |shear rate| d sqrt(rho_grain / stress), solved for the shear rate, 1/s.
inline double shear_rate_of(const Grains& grains, double inertial_number, double stress) {
  return inertial_number * std::sqrt(stress / grains.density) / grains.diameter;
}

inline double inertial_number_of(const Grains& grains, double shear_rate, double stress) {
  return std::abs(shear_rate) * grains.diameter * std::sqrt(grains.density / stress);
}

/// 1/s, of the upper wall's speed over the height.
inline double wall_shear_rate(const ShearCell& cell, const SimpleShearPoint& point) {
  return shear_rate_of(cell.grains, point.inertial_number, cell.simple_shear.normal_stress);
}

/// 1/s, at which z shortens. Where the volume is constant x grows as fast, so that the shear rate is twice this.
inline double axial_rate(const ShearCell& cell, const BiaxialPoint& point) {
  return 0.5 * shear_rate_of(cell.grains, point.inertial_number, cell.biaxial.lateral_stress);
}

/// Steps for `time`, in s, a whole number of samples.
inline std::int64_t steps_for(const ShearProtocol& protocol, double time) {
  const double samples = time / (protocol.time_step * protocol.steps_per_sample);
  return std::llround(std::ceil(samples - 1e-9)) * protocol.steps_per_sample;
}

/// Of shear, without the compression before.
inline std::int64_t step_count(const ShearCell& cell, const SimpleShearPoint& point) {
  return steps_for(cell.protocol, (point.transient_strain + point.strain) / wall_shear_rate(cell, point));
}

inline std::int64_t step_count(const ShearCell& cell, const BiaxialPoint& point) {
  return steps_for(cell.protocol, point.axial_strain / axial_rate(cell, point));
}

}  // namespace talus::dem
