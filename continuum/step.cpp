#include "continuum/step.h"

#include <fmt/format.h>

#include <cmath>

#include "continuum/particles/move.h"
#include "continuum/stress/shear_rate.h"

namespace talus {
namespace {

/// As large as the limits allow, and an equal share of what is left to `dt_limit`, so that no sliver remains.
double time_step(const State& state, const StepSettings& settings, double dt_limit) {
  const double h = state.grid.spacing, g = state.gravity.norm();
  double dt = dt_limit;
  if (g > 0.0) dt = std::min(dt, settings.gravity_courant * std::sqrt(h / g));
  const double fastest = state.particles.velocities.cwiseAbs().maxCoeff() + g * dt;
  if (fastest > 0.0) dt = std::min(dt, settings.courant * h / fastest);
  for (const Source& source : state.sources) {  // what enters must not come far in its first step
    if (std::isfinite(source.next_layer_time()))
      dt = std::min(dt, settings.courant * h / source.velocity.cwiseAbs().maxCoeff());
  }
  return dt_limit / std::ceil(dt_limit / dt * (1.0 - 1e-9));
}

/// Steps end where gates open and where layers enter, so that neither comes late.
double next_event(const State& state) {
  double next = next_opening(state.walls, state.time);
  for (const Source& source : state.sources) {
    // A running source is served every step; one that waits, or an empty domain, would let a step run past it.
    if (source.layers == 0 || state.particles.count() == 0) next = std::min(next, source.next_layer_time());
  }
  return next;
}

double pic_share(const State& state, const StepSettings& settings, double dt) {
  const double g = state.gravity.norm();
  if (g <= 0.0) return 0.0;
  return std::min(1.0,
                  settings.pic_share * dt / (settings.gravity_courant * std::sqrt(state.grid.spacing / g)));
}

ActiveRegion region_of(const State& state) {
  return make_active_region(state.grid, state.sides, state.particles.positions, state.openings);
}

void accelerate(const ActiveRegion& region, const Eigen::Vector3d& gravity, double dt, Field& velocity) {
  for (int f = 0; f < region.open_faces; ++f)
    velocity[f] += dt * gravity[region.face_axis[static_cast<std::size_t>(f)]];
  for (const WallFace& wall : region.wall_faces) velocity[wall.face] += dt * gravity[wall.axis];
}

/// Takes out what has left the domain, and says so in the report.
void count_departed(State& state, StepReport& report) {
  const Departed departed = remove_departed(state.grid, state.particles);
  report.particles_left += departed.count;
  report.mass_left += departed.mass;
}

/// The change of velocity that solver tolerances are measured in: g dt, or without gravity what crosses
/// 1/1000 of a cell.
double velocity_scale(const State& state, double dt) {
  const double g = state.gravity.norm();
  return g > 0.0 ? g * dt : 1e-3 * state.grid.spacing / dt;
}

/// mu of each particle, by its material and by how its cell was sheared and pressed in the last step.
Eigen::ArrayXd friction_of_particles(const State& state) {
  Eigen::ArrayXd friction(state.particles.count());
  for (Eigen::Index p = 0; p < friction.size(); ++p) {
    const auto material = static_cast<std::size_t>(state.particles.materials[static_cast<std::size_t>(p)]);
    double shear_rate = 0.0, pressure = 0.0;
    if (state.warm) {
      const State::Warm& warm = *state.warm;
      const int dense = state.grid.cell_index(state.grid.cell_at(state.particles.positions.col(p)));
      const int cell = warm.region.cell_of_dense[static_cast<std::size_t>(dense)];
      if (cell >= 0) {
        shear_rate = warm.shear_rate[cell];
        pressure = warm.confining_pressure[cell];
      }
    }
    friction[p] = friction_at(state.materials[material], shear_rate, pressure);
  }
  return friction;
}

SchemeStress initial_stress(const State& state, Scheme scheme, const ActiveRegion& region, double dt) {
  if (!state.warm) return zero_stress(scheme, region);
  return carry_over(scheme, state.warm->region, state.warm->stress, region, dt / state.warm->dt);
}

/// Moves particles apart where they are packed too closely; the region is then that of where they are.
void correct_density(State& state, const StepSettings& settings, ActiveRegion& region, StepReport& report) {
  report.packing = correct_packing(region, state.materials, {settings.packing_tolerance, 2000},
                                   state.particles, settings.projection.record);
  if (report.packing.largest_displacement == 0.0) return;
  wrap_positions(state.grid, state.particles.positions);
  keep_out_of_walls(state.grid, state.openings, state.particles);
  wrap_positions(state.grid, state.particles.positions);  // a wall may have put them over a seam
  count_departed(state, report);
  region = region_of(state);
}

/// v~ on all faces and the stress that gives it.
struct Flow {
  Field velocity;
  SchemeStress stress;
};

Flow flow_of(State& state, const StepSettings& settings, const ActiveRegion& region, const GridState& before,
             double dt, StepReport& report) {
  Flow flow{before.velocity, initial_stress(state, settings.scheme, region, dt)};
  accelerate(region, state.gravity, dt, flow.velocity);
  const bool cold = !state.warm || state.contact_changed;
  report.projection += project(region, before, dt, state.gravity, velocity_scale(state, dt), cold,
                               settings.projection, state.lipschitz, flow.stress, flow.velocity);
  if (!flow.velocity.isFinite().all()) {
    throw NumericalError(
        fmt::format("a face velocity is not finite at t = {:.6g} s, dt = {:.3g} s", state.time, dt));
  }
  return flow;
}

/// What the next step starts from.
State::Warm warm_start(const State& state, ActiveRegion&& region, const GridState& before, Flow&& flow,
                       double dt) {
  Field sheared = shear_rate(region, flow.velocity);
  Field confining = confining_pressure(region, before.fill, pressure_of(flow.stress), flow.velocity,
                                       velocity_scale(state, dt)) /
                    (dt * region.grid.spacing * region.grid.spacing);
  return {std::move(region), std::move(flow.stress), std::move(sheared), std::move(confining), dt};
}

/// Velocities and, by the same gradients, shapes.
DeformReport update_particles(const StepSettings& settings, const ActiveRegion& region,
                              const GridState& before, const Flow& flow, double dt, State& state) {
  Particles& particles = state.particles;
  if (settings.transfer == Transfer::apic)
    update_velocities_apic(region, flow.velocity, particles);
  else
    update_velocities_flip(region, before.velocity, flow.velocity, pic_share(state, settings, dt), particles);
  if (!settings.reshape) return {};
  return deform(interpolate_gradient(region, flow.velocity, particles.positions), dt, state.materials,
                state.grid.spacing, particles);
}

ReshapeReport reshape(const StepSettings& settings, double dt, State& state) {
  if (!settings.reshape) return {};
  const auto allowed = [&](const Eigen::Vector3d& position) {
    return !state.openings.any() || distance_at(state.grid, state.openings, position).distance > 0.0;
  };
  return split_and_merge(state.grid, state.materials, allowed, settings.reshape_rules, dt, state.particles);
}

/// Gates that are due open; layers that are due enter.
void advance_time(State& state, double dt, StepReport& report) {
  const double event = next_event(state), opening = next_opening(state.walls, state.time);
  state.time += dt;
  if (std::abs(event - state.time) < 1e-9 * dt)
    state.time = event;  // so that round-off leaves no sliver of a step
  if (opening <= state.time) {
    state.openings = openings_of(state.grid, state.walls, state.time);
    state.contact_changed = true;
  }
  report.mass_added = emit(state.materials, state.time, state.sources, state.particles).mass;
  if (report.mass_added == 0.0) return;
  wrap_positions(state.grid, state.particles.positions);
  keep_out_of_walls(state.grid, state.openings, state.particles);
  count_departed(state, report);  // what a source blew out of the domain at once
}

/// Nothing is there to move.
StepReport empty_step(State& state, StepReport report) {
  report.packing.solve.converged = true;
  state.warm.reset();
  advance_time(state, report.dt, report);
  return report;
}

}  // namespace

StepReport step(State& state, const StepSettings& settings, double dt_limit) {
  StepReport report;
  dt_limit = std::min(dt_limit, next_event(state) - state.time);
  report.dt = state.particles.count() > 0 ? time_step(state, settings, dt_limit) : dt_limit;
  if (state.particles.count() == 0) return empty_step(state, report);

  // 1, 2. Correct the density, then accumulate mass and velocity onto the grid.
  ActiveRegion region = region_of(state);
  correct_density(state, settings, region, report);
  if (state.particles.count() == 0) return empty_step(state, report);
  const Eigen::ArrayXd friction = friction_of_particles(state);
  const GridState before = deposit(region, state.particles, state.materials, friction);

  // 3, 4. Gravity, then friction and pressure by staggered projections, give the intermediate velocity; once more with
  // half the time step where that would carry a particle too far.
  Flow flow = flow_of(state, settings, region, before, report.dt, report);
  Eigen::Matrix3Xd moves = moves_of(region, flow.velocity, report.dt, state.particles);
  while (largest_move(region.grid, moves) > largest_allowed_move) {
    ++report.retries;
    report.dt *= 0.5;
    flow = flow_of(state, settings, region, before, report.dt, report);
    moves = moves_of(region, flow.velocity, report.dt, state.particles);
  }

  // 6. Update particles: velocities, shapes and positions; then split and merge.
  report.deform = update_particles(settings, region, before, flow, report.dt, state);
  report.largest_move = largest_move(region.grid, moves);
  state.particles.positions += moves;
  wrap_positions(state.grid, state.particles.positions);
  report.collisions = collide_with_walls(state.grid, state.openings, friction, state.particles);
  wrap_positions(state.grid, state.particles.positions);  // a wall may have put them over a seam
  count_departed(state, report);
  report.reshape = reshape(settings, report.dt, state);

  state.warm = warm_start(state, std::move(region), before, std::move(flow), report.dt);
  state.contact_changed = false;
  advance_time(state, report.dt, report);
  return report;
}

}  // namespace talus
