// What stands at each of the six sides of the domain.
#pragma once

#include <array>

namespace talus {

/// An open side lets particles leave; a wall is fixed and impenetrable, with friction against it.
struct Side {
  bool wall = false;
  double friction = 0.0;  // mu_w = tan(wall friction angle); 0 is a smooth wall
};

/// sides[axis][0] is the lower, sides[axis][1] the upper side. Ignored on periodic axes.
using DomainSides = std::array<std::array<Side, 2>, 3>;

}  // namespace talus
