#include "continuum/io/budget.h"

#include <limits>
#include <nlohmann/json.hpp>

namespace talus {

double total_energy(const State& state) {
  const Particles& p = state.particles;
  const Eigen::ArrayXd kinetic = 0.5 * p.velocities.colwise().squaredNorm().transpose().array();
  const Eigen::ArrayXd potential =
      -(state.gravity.transpose() * (p.positions.colwise() - state.grid.origin)).transpose().array();
  return (p.masses * (kinetic + potential)).sum();
}

Budget::Budget(const State& initial)
    : initial_mass_(initial.particles.masses.sum()),
      initial_energy_(total_energy(initial)),
      present_mass_(initial_mass_),
      highest_energy_(initial_energy_),
      shortest_step_(std::numeric_limits<double>::infinity()),
      longest_step_(0.0) {}

void Budget::add(const State& state, const StepReport& report) {
  ++steps_;
  present_mass_ = state.particles.masses.sum();
  mass_left_ += report.mass_left;
  particles_left_ += report.particles_left;
  highest_energy_ = std::max(highest_energy_, total_energy(state));
  friction_iterations_ += report.projection.friction_iterations;
  pressure_iterations_ += report.projection.pressure_iterations;
  packing_iterations_ += report.packing.solve.iterations;
  cap_hits_ += report.projection.cap_hits + (report.packing.solve.converged ? 0 : 1);
  peak_fill_ = std::max(peak_fill_, report.packing.peak_fill);
  shortest_step_ = std::min(shortest_step_, report.dt);
  longest_step_ = std::max(longest_step_, report.dt);
  largest_move_ = std::max(largest_move_, report.largest_move);
}

nlohmann::json Budget::summary() const {
  return {
      {"steps", steps_},
      {"shortest_step_s", shortest_step_},
      {"longest_step_s", longest_step_},
      {"mass_kg", initial_mass_},
      {"mass_error", (present_mass_ + mass_left_ - initial_mass_) / initial_mass_},
      {"mass_left_kg", mass_left_},
      {"particles_left", particles_left_},
      {"energy_start_j", initial_energy_},
      {"energy_highest_j", highest_energy_},
      {"peak_fill", peak_fill_},
      {"largest_move_cells", largest_move_},
      {"friction_iterations", friction_iterations_},
      {"pressure_iterations", pressure_iterations_},
      {"packing_iterations", packing_iterations_},
      {"cap_hits", cap_hits_},
      {"converged", cap_hits_ == 0},
  };
}

}  // namespace talus
