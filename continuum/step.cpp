#include "continuum/step.h"

#include <fmt/format.h>

#include <cmath>

#include "continuum/grid/free_way.h"
#include "continuum/parallel.h"
#include "continuum/particles/sort.h"
#include "continuum/solids/body_contacts.h"
#include "continuum/solids/body_step.h"
#include "continuum/stress/shear_rate.h"

namespace talus {
namespace {

/// As large as the limits allow, and an equal share of what is left to `dt_limit`, so that no sliver remains.
/// Particles go with the grid's velocity: what one of them keeps for itself, in sand that has come to rest, shortens nothing.
double time_step(const State& state, const StepSettings& settings, const GridState& before, double dt_limit) {
  const double h = state.grid.spacing, g = state.gravity.norm();
  double dt = dt_limit;
  if (g > 0.0) dt = std::min(dt, settings.gravity_courant * std::sqrt(h / g));
  const double fastest = std::max(before.velocity.abs().maxCoeff(),
                                  fastest_surface(state.grid, state.bodies, twists_of(state.bodies), dt)) +
                         g * dt;
  if (fastest > 0.0) dt = std::min(dt, settings.courant * h / fastest);
  for (const Source& source : state.sources) {  // what enters must not come far in its first step
    if (std::isfinite(source.next_layer_time()))
      dt = std::min(dt, settings.courant * h / source.velocity.cwiseAbs().maxCoeff());
  }
  return dt_limit / std::ceil(dt_limit / dt * (1.0 - 1e-9));
}

/// Steps end where gates open and where layers enter, so that neither comes late.
double next_event(const State& state) {
  double next = std::min({next_opening(state.walls, state.time), next_motion_change(state.bodies, state.time),
                          next_explosion(state.explosions, state.time)});
  for (const Source& source : state.sources) {
    // A running source is served every step; one that waits, or an empty domain, would let a step run past it.
    if (source.layers == 0 || state.particles.count() == 0) next = std::min(next, source.next_layer_time());
  }
  return next;
}

/// So that the damping in a second does not depend on how long the steps are.
double pic_share(const State& state, const StepSettings& settings, double dt) {
  const double g = state.gravity.norm();
  if (g <= 0.0) return 0.0;
  return std::min(1.0, settings.pic_share * dt / (pic_reference_step * std::sqrt(state.grid.spacing / g)));
}

/// Where the particles are, and the region that this makes active.
struct Occupied {
  PointsByCell points;
  ActiveRegion region;
};

ActiveRegion region_of(const State& state, const PointsByCell& points, ActiveRegion&& spent) {
  return make_active_region(state.grid, state.sides, points, state.openings, std::move(spent));
}

/// In the memory of the last step's region, of which no more is needed than what its stress is carried over with.
Occupied occupied(State& state) {
  PointsByCell points = points_by_cell(state.grid, state.particles.positions);
  ActiveRegion region =
      region_of(state, points, state.warm ? take_tables(state.warm->region) : ActiveRegion{});
  return {std::move(points), std::move(region)};
}

/// The momentum that faces gain, N s. Stress within the sand gives none in sum: it is that of walls and bodies.
Eigen::Vector3d gained_momentum(const ActiveRegion& region, const Field& face_mass, const Field& gain) {
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
  for (int f = 0; f < region.open_faces; ++f)
    momentum[region.face_axis[static_cast<std::size_t>(f)]] += face_mass[f] * gain[f];
  for (const WallFace& wall : region.wall_faces)
    momentum[wall.axis] += face_mass[wall.face] * gain[wall.face];
  return momentum;
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

BodySurroundings around_bodies(const State& state) {
  return {state.grid, state.sides, state.walls, state.gravity};
}

/// The change of velocity that solver tolerances are measured in: g dt, or without gravity what crosses
/// 1/1000 of a cell.
double velocity_scale(const State& state, double dt) {
  const double g = state.gravity.norm();
  return g > 0.0 ? g * dt : 1e-3 * state.grid.spacing / dt;
}

/// mu of each particle, by its material and by how its cell was sheared and pressed in the last step.
Eigen::ArrayXd friction_of_particles(const State& state, const PointsByCell& points) {
  constexpr std::ptrdiff_t cells_in_block = 256;
  Eigen::ArrayXd friction(state.particles.count());
  for_each_block(points.cell_count(), cells_in_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c) {
      const int cell =
          state.warm ? state.warm->region.cell_of_dense[static_cast<std::size_t>(points.cells[c])] : -1;
      const double shear_rate = cell >= 0 ? state.warm->shear_rate[cell] : 0.0;
      const double pressure = cell >= 0 ? state.warm->confining_pressure[cell] : 0.0;
      for (int place = points.first[c]; place < points.first[c + 1]; ++place) {
        const int p = points.point(place);
        const auto material =
            static_cast<std::size_t>(state.particles.materials[static_cast<std::size_t>(p)]);
        friction[p] = friction_at(state.materials[material], shear_rate, pressure);
      }
    }
  });
  return friction;
}

SchemeStress initial_stress(const State& state, Scheme scheme, const ActiveRegion& region, double dt) {
  if (!state.warm) return zero_stress(scheme, region);
  return carry_over(scheme, state.warm->region, state.warm->stress, region, dt / state.warm->dt);
}

/// Moves particles apart where they are packed too closely; the region is then that of where they are.
void correct_density(State& state, const StepSettings& settings, Occupied& now, Stopwatch& watch,
                     StepReport& report) {
  report.packing =
      correct_packing(now.region, now.points, state.materials, {settings.packing_tolerance, 2000},
                      state.particles, settings.projection.record);
  report.seconds[Phase::packing] += watch.lap();
  if (report.packing.largest_displacement == 0.0) return;
  require_finite_positions(state.particles, "the density correction", state.time);
  wrap_positions(state.grid, state.particles.positions);
  keep_out_of_walls(state.grid, state.openings, state.particles);
  wrap_positions(state.grid, state.particles.positions);  // a wall may have put them over a seam
  count_departed(state, report);
  report.seconds[Phase::packing] += watch.lap();
  now.points = points_by_cell(state.grid, state.particles.positions);
  if (now.points.cells != now.region.dense_of_cell)
    now.region = region_of(state, now.points, std::move(now.region));
  report.seconds[Phase::region] += watch.lap();
}

/// v~ on all faces and the stress that gives it; and what the sand does to bodies.
struct Flow {
  Field velocity;
  SchemeStress stress;
  BodyCoupling bodies;
  Field speeds;                    // of bodies, with all impulses
  std::vector<Twist> accelerated;  // by gravity and torques alone
  std::vector<Twist> pushed;       // by the sand: what it changes
  std::vector<BodyImpulse> on_bodies;
  ProjectionReport projection;
  Eigen::Vector3d gained;  // by the stress, N s
};

/// The bodies' twists before the sand acts: by gravity, and by contacts as these would be were the sand to push as it last did.
std::vector<Twist> twists_without_sand(const State& state, std::span<const Twist> accelerated, double dt) {
  std::vector<Twist> with_sand(accelerated.begin(), accelerated.end());
  for (std::size_t b = 0; state.warm && b < with_sand.size(); ++b)
    with_sand[b] = with_sand[b] + dt * state.warm->sand_acceleration[b];
  std::vector<Twist> touched = with_sand;
  resolve_contacts(state.bodies, around_bodies(state), state.time, dt, touched);
  std::vector<Twist> twists;
  for (std::size_t b = 0; b < touched.size(); ++b)
    twists.push_back(accelerated[b] + (touched[b] - with_sand[b]));
  return twists;
}

Flow flow_of(State& state, const StepSettings& settings, const ActiveRegion& region, const GridState& before,
             double dt, Stopwatch& watch, StepReport& report) {
  Flow flow{before.velocity, initial_stress(state, settings.scheme, region, dt), {}, {}, {}, {}, {}, {}, {}};
  std::vector<Twist> without_sand;
  if (!state.bodies.empty()) {
    flow.bodies = BodyCoupling(region, state.bodies);
    flow.accelerated = accelerated_twists(state.bodies, state.gravity, dt);
    without_sand = twists_without_sand(state, flow.accelerated, dt);
  }
  flow.speeds = flow.bodies.speeds(without_sand);
  report.seconds[Phase::carry_over] += watch.lap();
  accelerate(region, state.gravity, dt, flow.velocity);
  const Field free_velocity = flow.velocity;
  const bool cold = !state.warm || state.contact_changed;
  const ProjectionReport projection =
      project(region, before, dt, state.gravity, velocity_scale(state, dt), cold, settings.projection,
              state.friction_solver, flow.bodies, flow.stress, flow.velocity, flow.speeds);
  report.projection += projection;
  report.seconds += projection.seconds;
  report.seconds[Phase::stress_other] += watch.lap() - projection.seconds.total();
  flow.projection = projection;
  require_finite(region, flow.velocity, state.time, dt);
  flow.gained = gained_momentum(region, before.face_mass, flow.velocity - free_velocity);
  if (!flow.speeds.isFinite().all()) {
    throw NumericalError(
        fmt::format("a body's velocity is not finite at t = {:.6g} s, dt = {:.3g} s", state.time, dt));
  }
  if (!state.bodies.empty()) {
    const std::vector<Twist> with_sand = flow.bodies.twists(flow.speeds);
    for (std::size_t b = 0; b < with_sand.size(); ++b) flow.pushed.push_back(with_sand[b] - without_sand[b]);
    flow.on_bodies =
        impulses_on_bodies(region, state.bodies, pressure_of(flow.stress), friction_of(flow.stress, region));
  }
  return flow;
}

/// Whether a solve has ended at its cap far from its tolerance (most_stagnations). Counts it, and throws where that was the last try.
bool stagnated(const State& state, const ProjectionReport& projection, double dt, StepReport& report) {
  if (projection.cap_hits == 0) return false;
  const double off = std::max(projection.friction_residual, projection.pressure_residual);
  const double allowed = velocity_scale(state, dt) + 0.01 * state.particles.velocities.cwiseAbs().maxCoeff();
  if (off <= allowed) return false;
  if (report.stagnations++ < most_stagnations) return true;
  throw NumericalError(fmt::format(
      "the solves of friction and pressure have stagnated at t = {:.6g} s: at their iteration cap they are "
      "off by "
      "{:.3g} m/s, {:.3g} m/s being allowed, and no less with {} shorter time steps, the last of {:.3g} s",
      state.time, off, allowed, most_stagnations, dt));
}

/// What the next step starts from.
State::Warm warm_start(const State& state, ActiveRegion&& region, const GridState& before, Flow&& flow,
                       double dt) {
  Field sheared = shear_rate(region, flow.velocity, flow.bodies, flow.speeds);
  Field confining = confining_pressure(region, before.fill, pressure_of(flow.stress), flow.velocity,
                                       velocity_scale(state, dt), flow.bodies, flow.speeds) /
                    (dt * region.grid.spacing * region.grid.spacing);
  for (Twist& change : flow.pushed) change = 1.0 / dt * change;
  return {std::move(region),     std::move(flow.stress), std::move(sheared), std::move(confining), dt,
          std::move(flow.pushed)};
}

/// Velocities, shapes and positions.
void update_particles(const StepSettings& settings, const Occupied& now, const GridState& before,
                      const Flow& flow, State& state, StepReport& report) {
  const Advance how{report.dt, settings.transfer, pic_share(state, settings, report.dt), settings.reshape};
  const AdvanceReport advanced =
      advance(now.region, now.points, before.velocity, flow.velocity, how, state.materials, state.particles);
  report.deform = advanced.deform;
  report.largest_move = advanced.largest_move;
}

ReshapeReport reshape(const StepSettings& settings, double dt, State& state) {
  if (!settings.reshape) return {};
  const auto allowed = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    return is_free_way(state.grid, state.openings, from, to);
  };
  return split_and_merge(state.grid, state.materials, allowed, settings.reshape_rules, dt, state.particles);
}

void find_openings(State& state) {
  find_openings(state.grid, state.solids.walls, state.bodies, state.solids.swellings, state.openings);
}

/// With the sand's impulses, and with contacts as these have it.
void move_bodies(State& state, const Flow& flow, double dt) {
  if (state.bodies.empty()) return;
  std::vector<Twist> twists;
  for (std::size_t b = 0; b < flow.pushed.size(); ++b) twists.push_back(flow.accelerated[b] + flow.pushed[b]);
  set_twists(twists, state.bodies);
  move_with_contacts(state.bodies, around_bodies(state), state.time, dt);
  find_openings(state);
}

/// What particles that met a body gave to it.
void push_bodies(State& state, StepReport& report) {
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const Eigen::Matrix<double, 6, 1>& by_particles = report.collisions.on_bodies[b];
    Body& body = state.bodies[b];
    body.twist = body.twist + push(body, by_particles.head<3>(), by_particles.tail<3>());
    report.on_bodies[b].linear += by_particles.head<3>();
    report.on_bodies[b].angular += by_particles.tail<3>();
  }
}

/// Gates that are due open, explosions go off, layers that are due enter.
void advance_time(State& state, double dt, StepReport& report) {
  const double event = next_event(state), opening = next_opening(state.walls, state.time);
  const double before = state.time;
  state.time += dt;
  if (std::abs(event - state.time) < 1e-9 * dt)
    state.time = event;  // so that round-off leaves no sliver of a step
  apply_explosions(state.grid, state.explosions, before, state.time, state.particles, state.bodies);
  if (opening <= state.time) {
    state.openings = openings_of(state.grid, state.walls, state.time);
    if (!state.bodies.empty()) {
      state.solids.walls = std::move(state.openings);
      find_openings(state);
    }
    state.contact_changed = true;
  }
  report.mass_added = emit(state.materials, state.time, state.sources, state.particles).mass;
  if (report.mass_added == 0.0) return;
  wrap_positions(state.grid, state.particles.positions);
  keep_out_of_walls(state.grid, state.openings, state.particles);
  count_departed(state, report);  // what a source blew out of the domain at once
}

/// From the start of a step on, particles carry along which render points are theirs.
void track_render_points(State& state, Stopwatch& watch, StepReport& report) {
  if (!state.render_points.wanted()) return;
  if (state.render_points.particle_count() != state.particles.count())
    throw std::invalid_argument("render points belong to other particles");
  state.particles.track_origins();
  report.seconds[Phase::render_points] += watch.lap();
}

/// Render points go with the flow, before their particles do; returns what hides them.
std::vector<Cover> move_render_points(const Occupied& now, const GridState& before, const Flow& flow,
                                      State& state, Stopwatch& watch, StepReport& report) {
  if (!state.render_points.wanted()) return {};
  talus::move_render_points(now.region, now.points, flow.velocity, report.dt, state.particles,
                            state.render_points);
  std::vector<Cover> cover = cover_of_cells(now.region, before.fill);
  report.seconds[Phase::render_points] += watch.lap();
  return cover;
}

/// Where the owners of render points are.
Eigen::Matrix3Xd centres_of_owners(const State& state, Stopwatch& watch, StepReport& report) {
  Eigen::Matrix3Xd centres(3, state.render_points.particle_count());
  if (!state.render_points.wanted()) return centres;
  for (Eigen::Index p = 0; p < state.particles.origins.cols(); ++p)
    centres.col(state.particles.origins(0, p)) = state.particles.positions.col(p);
  report.seconds[Phase::render_points] += watch.lap();
  return centres;
}

/// Gives render points to what has become of their owners.
void hand_over_render_points(const Eigen::Matrix3Xd& centres, const std::vector<Cover>& cover, State& state,
                             Stopwatch& watch, StepReport& report) {
  if (!state.render_points.wanted()) return;
  const ActiveRegion* region = state.warm ? &state.warm->region : nullptr;
  report.render_points = hand_over({state.grid, state.sides, state.openings, region, cover}, state.materials,
                                   centres, state.particles, state.render_points);
  state.particles.origins.resize(2, 0);
  report.seconds[Phase::render_points] += watch.lap();
}

/// Nothing is there to move.
StepReport empty_step(State& state, Stopwatch& watch, StepReport report) {
  report.packing.solve.converged = true;
  state.warm.reset();
  if (!state.bodies.empty()) {
    set_twists(accelerated_twists(state.bodies, state.gravity, report.dt), state.bodies);
    move_with_contacts(state.bodies, around_bodies(state), state.time, report.dt);
    find_openings(state);
  }
  advance_time(state, report.dt, report);
  report.seconds[Phase::other] += watch.lap();
  const Eigen::Matrix3Xd centres = centres_of_owners(state, watch, report);
  hand_over_render_points(centres, {}, state, watch, report);
  return report;
}

}  // namespace

void add_bodies(State& state, std::vector<Body> bodies) {
  state.bodies = std::move(bodies);
  state.solids.walls = std::move(state.openings);
  state.solids.swellings = swellings(state.bodies, state.grid.spacing);
  find_openings(state);
}

StepReport step(State& state, const StepSettings& settings, double dt_limit) {
  Stopwatch watch;
  StepReport report;
  require_sound(state.grid, state.particles, state.time);
  require_sound(state.bodies, state.time);
  if (state.warm) require_finite(state.warm->region, state.warm->stress, state.time);
  dt_limit = std::min(dt_limit, next_event(state) - state.time);
  report.dt = dt_limit;
  report.seconds[Phase::other] += watch.lap();
  track_render_points(state, watch, report);
  if (state.particles.count() == 0) return empty_step(state, watch, report);

  // 1, 2. Correct the density, then accumulate mass and velocity onto the grid.
  Occupied now = occupied(state);
  report.seconds[Phase::region] += watch.lap();
  correct_density(state, settings, now, watch, report);
  if (state.particles.count() == 0) return empty_step(state, watch, report);
  sort_by_cell(now.points, state.particles);
  const Eigen::ArrayXd friction = friction_of_particles(state, now.points);
  const GridState before = deposit(now.region, now.points, state.particles, state.materials, friction);
  report.dt = time_step(state, settings, before, dt_limit);
  report.seconds[Phase::deposit] += watch.lap();

  // 3, 4. Gravity, then friction and pressure by staggered projections, give the intermediate velocity; once more with
  // half the time step where that would carry a particle too far.
  Flow flow = flow_of(state, settings, now.region, before, report.dt, watch, report);
  const auto too_far = [&] {
    const double fastest_body =
        fastest_surface(state.grid, state.bodies, flow.bodies.twists(flow.speeds), report.dt);
    return fastest_body * report.dt > largest_allowed_move * state.grid.spacing ||
           moves_further(now.region, now.points, flow.velocity, report.dt, state.particles,
                         largest_allowed_move);
  };
  while (stagnated(state, flow.projection, report.dt, report) || too_far()) {
    report.seconds[Phase::move] += watch.lap();
    ++report.retries;
    report.dt *= 0.5;
    flow = flow_of(state, settings, now.region, before, report.dt, watch, report);
  }

  // 6. Update particles: velocities, shapes and positions; then split and merge.
  report.seconds[Phase::move] += watch.lap();
  const std::vector<Cover> cover = move_render_points(now, before, flow, state, watch, report);
  update_particles(settings, now, before, flow, state, report);
  require_finite_positions(state.particles, "the step", state.time);
  wrap_positions(state.grid, state.particles.positions);
  report.on_bodies = flow.on_bodies;
  report.solids_impulse = flow.gained;
  move_bodies(state, flow, report.dt);
  report.collisions = collide_with_walls(state.grid, state.openings, friction, state.particles, state.bodies);
  push_bodies(state, report);
  wrap_positions(state.grid, state.particles.positions);  // a wall may have put them over a seam
  count_departed(state, report);
  report.seconds[Phase::move] += watch.lap();
  const Eigen::Matrix3Xd centres = centres_of_owners(state, watch, report);
  report.reshape = reshape(settings, report.dt, state);
  report.seconds[Phase::reshape] += watch.lap();

  state.warm = warm_start(state, std::move(now.region), before, std::move(flow), report.dt);
  report.seconds[Phase::warm_start] += watch.lap();
  state.contact_changed = false;
  advance_time(state, report.dt, report);
  report.seconds[Phase::other] += watch.lap();
  hand_over_render_points(centres, cover, state, watch, report);
  return report;
}

}  // namespace talus
