// One time step, as figure 5.7 of the source has it.
//
// The limit of half a cell a step is kept by expectation: the step length is chosen from the particles' velocities before
// the solve, with a margin (courant), and what came of it is reported (largest_move), not enforced.
#pragma once

#include <optional>
#include <vector>

#include "continuum/grid/active_region.h"
#include "continuum/particles/transfer.h"
#include "continuum/stress/packing.h"
#include "continuum/stress/staggered_projections.h"

namespace talus {

/// All that a simulation is between two steps.
struct State {
  Grid grid;
  DomainSides sides;
  std::vector<Material> materials;
  Eigen::Vector3d gravity;  // m/s^2
  Particles particles;
  double time = 0.0;  // s

  /// What the last step left for the next one to start from.
  struct Warm {
    ActiveRegion region;
    Stress stress;
    double dt;
  };
  std::optional<Warm> warm;
  double lipschitz = 1.0;  // of the friction solve; grows to what is needed
};

struct StepSettings {
  ProjectionSettings projection;
  double packing_tolerance = 0.005;  // fill above 1 that the density correction leaves alone
  double courant = 0.4;           // cells a particle may move in a step, expected; the method's limit is 0.5
  double gravity_courant = 0.25;  // dt <= this * sqrt(h / g)                         (method.md, section 8)
  double pic_share = 0.02;        // of a step of 0.25 sqrt(h / g); scales with dt
};

/// What a step did, for budgets.
struct StepReport {
  double dt = 0.0;
  ProjectionReport projection;
  PackingResult packing;
  double largest_move = 0.0;        // in cells
  Eigen::Index particles_left = 0;  // left the domain through an open side
  double mass_left = 0.0;           // kg
};

/// Advances by one time step of at most `dt_limit` seconds. Throws NumericalError when a velocity is not
/// finite.
StepReport step(State& state, const StepSettings& settings, double dt_limit);

class NumericalError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace talus
