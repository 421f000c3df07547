// Numerical faults: what is not finite, or out of bounds, is told with its place and stops the run before anything is built on it.
#pragma once

#include <span>
#include <stdexcept>
#include <string_view>

#include "continuum/grid/active_region.h"
#include "continuum/grid/operators.h"
#include "continuum/particles/particles.h"
#include "continuum/solids/body.h"
#include "continuum/stress/scheme.h"

namespace talus {

/// The simulation cannot go on: the message names the quantity, the place and the time.
class NumericalError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Every particle finite, of positive mass and inside the domain. Throws NumericalError about the first that is not; `time` in s.
void require_sound(const Grid& grid, const Particles& particles, double time);
/// Every position finite, inside the domain or not; `after`: what has moved them. Throws NumericalError.
void require_finite_positions(const Particles& particles, std::string_view after, double time);
/// Every body's pose and twist finite. Throws NumericalError.
void require_sound(std::span<const Body> bodies, double time);
/// All of the stress that a step left finite, on the region that it is on. Throws NumericalError.
void require_finite(const ActiveRegion& region, const SchemeStress& stress, double time);
/// Every velocity (of all faces) finite. Throws NumericalError about the first that is not.
void require_finite(const ActiveRegion& region, const Field& velocity, double time, double dt);

}  // namespace talus
