// The constants of a granular material, and its friction. They come from the calibration case only.
//
// mu(I) = mu_1 + (mu_2 - mu_1) / (1 + I_0 / I),   I = |shear rate| d sqrt(rho_grain / p)   (method.md, section 9)
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace talus {

/// What friction gains with the inertial number I, beside mu_1.
struct RateDependence {
  double fast_friction;  // mu_2, as I grows
  double
      inertial_number;  // I_0, where half of the gain is reached; 0 where friction does not depend on the rate
  double grain_diameter;  // d, m
};

struct Material {
  std::string name;
  double grain_density;        // rho_grain, kg/m^3
  double max_volume_fraction;  // phi_max, the critical-state packing
  double friction;             // mu_1, the quasi-static coefficient
  RateDependence rate{0.0, 0.0, 0.0};

  double max_density() const { return max_volume_fraction * grain_density; }  // rho_max, kg/m^3
};

/// mu at a shear rate |gamma| (1/s) and pressure p (Pa).
inline double friction_at(const Material& material, double shear_rate, double pressure) {
  const RateDependence& rate = material.rate;
  if (rate.inertial_number <= 0.0 || shear_rate <= 0.0) return material.friction;
  // I_0 / I, which is 0 where nothing presses.
  const double slowness = rate.inertial_number * std::sqrt(std::max(pressure, 0.0) / material.grain_density) /
                          (shear_rate * rate.grain_diameter);
  return material.friction + (rate.fast_friction - material.friction) / (1.0 + slowness);
}

}  // namespace talus
