#include "dem_cases/yade/rolling.h"

#include <cmath>

namespace talus::dem::yade {

double rolling_stiffness(const Grains& grains, double rolling_friction, double pressure) {
  if (rolling_friction == 0.0) return 0.0;
  const double radius = 0.25 * grains.diameter;  // R*, of two equal grains
  const double modulus =
      grains.youngs_modulus / (2.0 * (1.0 - grains.poissons_ratio * grains.poissons_ratio));
  const double shear_modulus =
      grains.youngs_modulus / (4.0 * (1.0 + grains.poissons_ratio) * (2.0 - grains.poissons_ratio));
  const double force = pressure * grains.diameter * grains.diameter;
  const double overlap = std::pow(0.75 * force / (modulus * std::sqrt(radius)), 2.0 / 3.0);
  return 8.0 * shear_modulus * std::sqrt(radius * overlap) * radius * radius;
}

}  // namespace talus::dem::yade
