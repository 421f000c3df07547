// Rolling friction in YADE's terms.
#pragma once

#include "dem_cases/case.h"

namespace talus::dem::yade {

/// LIGGGHTS' epsd2 gives each contact the rolling stiffness k_t R*^2, k_t = 8 G* sqrt(R* overlap) (Iwashita &
/// Oda 1998); YADE takes one number for all contacts, N m, so it gets that of a contact of two mean grains that carries
/// `pressure` (Pa) on a diameter squared. The limit of the moment, not this stiffness, decides how grains roll. 0, which
/// takes rolling out, without rolling friction.
double rolling_stiffness(const Grains& grains, double rolling_friction, double pressure);

/// YADE limits the moment by eta (R1 + R2) / 2 F_n, the case by mu_r R1 R2 / (R1 + R2) F_n: for equal grains eta = mu_r / 2.
/// Against a box or facet YADE takes the grain's radius for both, which makes a plane count as a grain of equal size.
inline double rolling_resistance(double rolling_friction) { return 0.5 * rolling_friction; }

}  // namespace talus::dem::yade
