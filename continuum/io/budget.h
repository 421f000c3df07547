// The books of a run: what was conserved, what was spent, and whether every solve converged.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "continuum/step.h"

namespace talus {

/// Kinetic + potential energy of the particles, J; potential energy is zero at the domain's lower corner.
double total_energy(const State& state);

struct Budget {
  explicit Budget(const State& initial);

  void add(const State& state, const StepReport& report);
  /// All figures by name, with units in the names.
  nlohmann::json summary() const;

 private:
  double initial_mass_;    // kg
  double initial_energy_;  // J
  double present_mass_;
  double mass_left_ = 0.0;
  Eigen::Index particles_left_ = 0;
  double highest_energy_;  // J, over all steps
  long steps_ = 0;
  long friction_iterations_ = 0;
  long pressure_iterations_ = 0;
  long packing_iterations_ = 0;
  long cap_hits_ = 0;
  double peak_fill_ = 0.0;
  double shortest_step_;       // s
  double longest_step_;        // s
  double largest_move_ = 0.0;  // cells
};

}  // namespace talus
