// The constants of a granular material. They come from the calibration case only.
#pragma once

#include <string>

namespace talus {

struct Material {
  std::string name;
  double grain_density;        // rho_grain, kg/m^3
  double max_volume_fraction;  // phi_max, the critical-state packing
  double friction;             // mu = tan(friction angle)

  double max_density() const { return max_volume_fraction * grain_density; }  // rho_max, kg/m^3
};

}  // namespace talus
