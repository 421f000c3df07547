#include "continuum/step.h"

#include <fmt/format.h>

#include <cmath>

#include "continuum/particles/move.h"

namespace talus {
namespace {

/// As large as the limits allow, and an equal share of what is left to `dt_limit`, so that no sliver remains.
double time_step(const State& state, const StepSettings& settings, double dt_limit) {
  const double h = state.grid.spacing, g = state.gravity.norm();
  double dt = dt_limit;
  if (g > 0.0) dt = std::min(dt, settings.gravity_courant * std::sqrt(h / g));
  const double fastest = state.particles.velocities.cwiseAbs().maxCoeff() + g * dt;
  if (fastest > 0.0) dt = std::min(dt, settings.courant * h / fastest);
  return dt_limit / std::ceil(dt_limit / dt * (1.0 - 1e-9));
}

double pic_share(const State& state, const StepSettings& settings, double dt) {
  const double g = state.gravity.norm();
  if (g <= 0.0) return 0.0;
  return std::min(1.0,
                  settings.pic_share * dt / (settings.gravity_courant * std::sqrt(state.grid.spacing / g)));
}

ActiveRegion region_of(const State& state) {
  return make_active_region(state.grid, state.sides, state.particles.positions);
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

/// Nothing is left to move.
StepReport empty_step(State& state, StepReport report, double dt) {
  report.dt = dt;
  report.packing.solve.converged = true;
  state.time += dt;
  state.warm.reset();
  return report;
}

Stress initial_stress(State& state, const ActiveRegion& region, double dt) {
  if (!state.warm) return zero_stress(region);
  return carry_over(state.warm->region, state.warm->stress, region, dt / state.warm->dt);
}

}  // namespace

StepReport step(State& state, const StepSettings& settings, double dt_limit) {
  StepReport report;
  if (state.particles.count() == 0) return empty_step(state, report, dt_limit);
  const double dt = report.dt = time_step(state, settings, dt_limit);

  // 1, 2. Correct the density, then accumulate mass and velocity onto the grid.
  ActiveRegion region = region_of(state);
  report.packing =
      correct_packing(region, state.materials, {settings.packing_tolerance, 2000}, state.particles);
  if (report.packing.largest_displacement > 0.0) {
    wrap_positions(state.grid, state.particles.positions);
    count_departed(state, report);
    if (state.particles.count() == 0) return empty_step(state, report, dt);
    region = region_of(state);
  }
  const GridState before = deposit(region, state.particles, state.materials);

  // 3, 4. Gravity, then friction and pressure by staggered projections, give the intermediate velocity.
  Field velocity = before.velocity;
  accelerate(region, state.gravity, dt, velocity);
  Stress stress = initial_stress(state, region, dt);
  report.projection = project(region, before, dt, velocity_scale(state, dt), !state.warm, settings.projection,
                              state.lipschitz, stress, velocity);
  if (!velocity.isFinite().all()) {
    throw NumericalError(
        fmt::format("a face velocity is not finite at t = {:.6g} s, dt = {:.3g} s", state.time, dt));
  }

  // 6. Update particles: velocities by FLIP, then positions.
  update_velocities(region, before.velocity, velocity, pic_share(state, settings, dt), state.particles);
  report.largest_move = move_particles(region, velocity, dt, state.particles) / state.grid.spacing;
  count_departed(state, report);

  state.warm = State::Warm{std::move(region), std::move(stress), dt};
  state.time += dt;
  return report;
}

}  // namespace talus
