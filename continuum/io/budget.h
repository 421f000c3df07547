// The books of a run: what was conserved, what was spent, and whether every solve converged. One row a step, and a
// summary at the end.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "continuum/step.h"

namespace talus {

/// Kinetic + potential energy of the particles and of the bodies that forces move, J; potential energy is zero at the domain's
/// lower corner.
double total_energy(const State& state);

class Budget {
 public:
  explicit Budget(const State& initial);

  void add(const State& state, const StepReport& report);

  /// The names of a row's columns, with their units, and the row of the last step: comma-separated values.
  static std::string header();
  std::string row() const;

  /// All figures of the run by name, with units in the names.
  nlohmann::json summary() const;

  /// What has been added up, as fields of an archive (archive.h), and back: `state` is the one that they were added up to. Throws
  /// InputError that names `where` when they are not those of a budget.
  nlohmann::json fields() const;
  Budget(const nlohmann::json& fields, const std::string& where, const State& state);

 private:
  template <class Archive, class Of>
  static void describe(Archive& archive, Of& budget);

  double initial_mass_;    // kg
  double initial_energy_;  // J
  double mass_added_ = 0.0;
  double mass_left_ = 0.0;
  Eigen::Index particles_left_ = 0;
  double highest_energy_;  // J, over all steps
  long steps_ = 0;
  long friction_iterations_ = 0;
  long pressure_iterations_ = 0;
  long packing_iterations_ = 0;
  long cap_hits_ = 0;
  long splits_ = 0;
  long merges_ = 0;
  double merge_energy_lost_ = 0.0;  // J
  long splits_put_off_ = 0;         // once a step and particle
  long shapes_not_finite_ = 0;
  long stagnations_ = 0;
  double peak_fill_ = 0.0;
  double shortest_step_;            // s
  double longest_step_ = 0.0;       // s
  double largest_move_ = 0.0;       // cells
  double deepest_collision_ = 0.0;  // m
  double bulk_volume_ = 0.0;        // m^3, of the last step

  /// What the last row tells of the particles.
  struct Moment {
    double time = 0.0, mass = 0.0, kinetic_energy = 0.0, potential_energy = 0.0;
    double bodies_kinetic_energy = 0.0,
           bodies_potential_energy = 0.0;  // of those whose motion is not prescribed
    double energy() const {
      return kinetic_energy + potential_energy + bodies_kinetic_energy + bodies_potential_energy;
    }
    Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
    Eigen::Index particles = 0;
  };
  static Moment moment_of(const State& state);
  Moment now_;
  StepReport last_;
};

}  // namespace talus
