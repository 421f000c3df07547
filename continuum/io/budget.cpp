#include "continuum/io/budget.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "continuum/io/archive.h"

namespace talus {

Budget::Moment Budget::moment_of(const State& state) {
  const Particles& p = state.particles;
  Moment m;
  m.time = state.time;
  m.particles = p.count();
  m.mass = p.masses.sum();
  m.momentum = p.velocities * p.masses.matrix();
  m.kinetic_energy = 0.5 * (p.masses * p.velocities.colwise().squaredNorm().transpose().array()).sum();
  m.potential_energy =
      -(p.masses *
        (state.gravity.transpose() * (p.positions.colwise() - state.grid.origin)).transpose().array())
           .sum();
  for (const Body& body : state.bodies) {
    if (std::holds_alternative<Prescribed>(body.motion)) continue;
    const Eigen::Vector3d spin = body.pose.orientation.conjugate() * body.twist.angular_velocity;
    m.bodies_kinetic_energy +=
        0.5 * (body.mass * body.twist.velocity.squaredNorm() + spin.dot(body.inertia * spin));
    m.bodies_potential_energy -= body.mass * state.gravity.dot(body.pose.position - state.grid.origin);
  }
  return m;
}

double total_energy(const State& state) { return Budget(state).summary()["energy_start_j"].get<double>(); }

Budget::Budget(const State& initial)
    : shortest_step_(std::numeric_limits<double>::infinity()), now_(moment_of(initial)) {
  initial_mass_ = now_.mass;
  highest_energy_ = initial_energy_ = now_.energy();
}

void Budget::add(const State& state, const StepReport& report) {
  ++steps_;
  now_ = moment_of(state);
  last_ = report;
  mass_added_ += report.mass_added;
  mass_left_ += report.mass_left;
  particles_left_ += report.particles_left;
  highest_energy_ = std::max(highest_energy_, now_.energy());
  friction_iterations_ += report.projection.friction_iterations;
  pressure_iterations_ += report.projection.pressure_iterations;
  packing_iterations_ += report.packing.solve.iterations;
  cap_hits_ += report.cap_hits();
  splits_ += report.reshape.split.splits;
  merges_ += report.reshape.merge.merges;
  merge_energy_lost_ += report.reshape.merge.energy_lost;
  splits_put_off_ += report.reshape.split.put_off + report.reshape.split.unfinished;
  shapes_not_finite_ += report.deform.not_finite;
  stagnations_ += report.stagnations;
  peak_fill_ = std::max(peak_fill_, report.packing.peak_fill);
  shortest_step_ = std::min(shortest_step_, report.dt);
  longest_step_ = std::max(longest_step_, report.dt);
  largest_move_ = std::max(largest_move_, report.largest_move);
  deepest_collision_ = std::max(deepest_collision_, report.collisions.deepest);
  bulk_volume_ = report.packing.bulk_volume;
}

template <class Archive, class Of>
void Budget::describe(Archive& archive, Of& budget) {
  archive.number("initial_mass", budget.initial_mass_);
  archive.number("initial_energy", budget.initial_energy_);
  archive.number("mass_added", budget.mass_added_);
  archive.number("mass_left", budget.mass_left_);
  archive.number("particles_left", budget.particles_left_);
  archive.number("highest_energy", budget.highest_energy_);
  archive.number("steps", budget.steps_);
  archive.number("friction_iterations", budget.friction_iterations_);
  archive.number("pressure_iterations", budget.pressure_iterations_);
  archive.number("packing_iterations", budget.packing_iterations_);
  archive.number("cap_hits", budget.cap_hits_);
  archive.number("splits", budget.splits_);
  archive.number("merges", budget.merges_);
  archive.number("merge_energy_lost", budget.merge_energy_lost_);
  archive.number("splits_put_off", budget.splits_put_off_);
  archive.number("shapes_not_finite", budget.shapes_not_finite_);
  archive.number("stagnations", budget.stagnations_);
  archive.number("peak_fill", budget.peak_fill_);
  archive.number("shortest_step", budget.shortest_step_);
  archive.number("longest_step", budget.longest_step_);
  archive.number("largest_move", budget.largest_move_);
  archive.number("deepest_collision", budget.deepest_collision_);
  archive.number("bulk_volume", budget.bulk_volume_);
}

nlohmann::json Budget::fields() const {
  ArchiveWriter archive;
  describe(archive, *this);
  return archive.fields();
}

Budget::Budget(const nlohmann::json& fields, const std::string& where, const State& state) : Budget(state) {
  ArchiveReader archive(fields, where);
  describe(archive, *this);
}

std::string Budget::header() {
  return "step,time_s,dt_s,particles,mass_kg,mass_added_kg,mass_left_kg,momentum_x_kg_m_s,momentum_y_kg_m_s,"
         "momentum_z_kg_m_s,kinetic_energy_j,potential_energy_j,bulk_volume_m3,peak_fill,friction_iterations,"
         "pressure_iterations,packing_iterations,friction_residual_m_s,pressure_residual_m_s,cap_hits,"
         "largest_move_cells,wall_collisions,wall_impulse_x_kg_m_s,wall_impulse_y_kg_m_s,"
         "wall_impulse_z_kg_m_s,splits,merges,merge_energy_lost_j,retries,"
         "bodies_kinetic_energy_j,bodies_potential_energy_j,solids_impulse_x_kg_m_s,solids_impulse_y_kg_m_s,"
         "solids_impulse_z_kg_m_s\n";
}

std::string Budget::row() const {
  const StepReport& r = last_;
  return fmt::format(
      "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}"
      "\n",
      steps_, now_.time, r.dt, now_.particles, now_.mass, r.mass_added, r.mass_left, now_.momentum[0],
      now_.momentum[1], now_.momentum[2], now_.kinetic_energy, now_.potential_energy, r.packing.bulk_volume,
      r.packing.peak_fill, r.projection.friction_iterations, r.projection.pressure_iterations,
      r.packing.solve.iterations, r.projection.friction_residual, r.projection.pressure_residual,
      r.cap_hits(), r.largest_move, r.collisions.count, r.collisions.impulse[0], r.collisions.impulse[1],
      r.collisions.impulse[2], r.reshape.split.splits, r.reshape.merge.merges, r.reshape.merge.energy_lost,
      r.retries, now_.bodies_kinetic_energy, now_.bodies_potential_energy, r.solids_impulse[0],
      r.solids_impulse[1], r.solids_impulse[2]);
}

nlohmann::json Budget::summary() const {
  return {
      {"steps", steps_},
      {"shortest_step_s", shortest_step_},
      {"longest_step_s", longest_step_},
      {"mass_kg", initial_mass_},
      {"mass_error",
       initial_mass_ + mass_added_ > 0.0
           ? (now_.mass + mass_left_ - initial_mass_ - mass_added_) / (initial_mass_ + mass_added_)
           : 0.0},
      {"mass_added_kg", mass_added_},
      {"mass_left_kg", mass_left_},
      {"particles_left", particles_left_},
      {"energy_start_j", initial_energy_},
      {"energy_highest_j", highest_energy_},
      {"bulk_volume_m3", bulk_volume_},
      {"peak_fill", peak_fill_},
      {"largest_move_cells", largest_move_},
      {"deepest_collision_m", deepest_collision_},
      {"splits", splits_},
      {"merges", merges_},
      {"merge_energy_lost_j", merge_energy_lost_},
      {"splits_put_off", splits_put_off_},
      {"shapes_not_finite", shapes_not_finite_},
      {"friction_iterations", friction_iterations_},
      {"pressure_iterations", pressure_iterations_},
      {"packing_iterations", packing_iterations_},
      {"cap_hits", cap_hits_},
      {"stagnations", stagnations_},
      {"converged", cap_hits_ == 0},
  };
}

}  // namespace talus
