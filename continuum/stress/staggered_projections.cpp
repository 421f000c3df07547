#include "continuum/stress/staggered_projections.h"

#include "continuum/stress/assemble.h"
#include "continuum/stress/pressure.h"

namespace talus {
namespace {

constexpr Eigen::Index values_per_wall_face = 2 * copies_per_wall_face;

Field joined(const Field& first, const Field& last) {
  Field both(first.size() + last.size());
  both << first, last;
  return both;
}

/// Inverse of the mass each open face moves with, 0 for the null face.
Field inverse_face_mass(const ActiveRegion& region, const GridState& state) {
  const Eigen::Index faces = region.open_faces + 1;
  const Field fill = state.face_volume.head(faces) / region.grid.cell_volume();
  // Same density, at least the smallest fill: mass * max(fill, smallest) / fill.
  Field inverse =
      (state.face_mass.head(faces) > 0.0)
          .select(fill / (state.face_mass.head(faces) * fill.max(smallest_face_fill * region.face_kernel))
                             .max(1e-300),
                  0.0);
  inverse[region.null_face()] = 0.0;
  return inverse;
}

double square(double value) { return value * value; }

/// The impulse each wall face absorbs in its half cell, which the pressure never sees; and the one-sided wall
/// velocity: grains may leave a wall, not enter it.
Eigen::ArrayXd stop_at_walls(const ActiveRegion& region, const GridState& state, Field& velocity) {
  Eigen::ArrayXd reaction(static_cast<Eigen::Index>(region.wall_faces.size()));
  for (std::size_t w = 0; w < region.wall_faces.size(); ++w) {
    const WallFace& wall = region.wall_faces[w];
    const double into_wall = std::max(0.0, -wall.inward * velocity[wall.face]);
    reaction[static_cast<Eigen::Index>(w)] = state.face_mass[wall.face] * into_wall;
    if (into_wall > 0.0) velocity[wall.face] = 0.0;
  }
  return reaction;
}

}  // namespace

ProjectionReport& ProjectionReport::operator+=(const ProjectionReport& later) {
  pressure_iterations += later.pressure_iterations;
  friction_iterations += later.friction_iterations;
  cap_hits += later.cap_hits;
  pressure_residual = later.pressure_residual;
  friction_residual = later.friction_residual;
  seconds += later.seconds;
  return *this;
}

ProjectionReport project(const ActiveRegion& region, const GridState& state, double dt, double velocity_scale,
                         bool cold, const ProjectionSettings& settings, FrictionSolver& solver,
                         Stress& stress, Field& velocity) {
  Field no_speeds(0);
  return project(region, state, dt, velocity_scale, cold, settings, solver, no_bodies(), stress, velocity,
                 no_speeds);
}

ProjectionReport project(const ActiveRegion& region, const GridState& state, double dt, double velocity_scale,
                         bool cold, const ProjectionSettings& settings, FrictionSolver& solver,
                         const BodyCoupling& bodies, Stress& stress, Field& velocity, Field& speeds) {
  const Eigen::Index faces = region.open_faces + 1;
  const double tolerance = settings.tolerance * velocity_scale;
  const Eigen::ArrayXd reaction = stop_at_walls(region, state, velocity);
  const Field free_velocity = velocity.head(faces);
  const Field inverse_mass = inverse_face_mass(region, state);
  const Field mass = (inverse_mass > 0.0).select(inverse_mass.max(1e-300).inverse(), 0.0);
  const Field room = (packed_fill - state.fill).max(0.0) * (region.grid.spacing / dt);

  const FrictionOperator friction(region);
  friction.clear_idle(stress.copies);
  BallBlocks balls = friction.blocks(inverse_mass, bodies);
  solver.prepare(region, inverse_mass, bodies);
  ConeProjectionSettings cone{0.0, settings.max_friction_iterations};
  const BoundQpSettings bound{tolerance, settings.max_pressure_iterations};

  PressureSolver pressure(region, inverse_mass, bodies);
  const Field free_speeds = speeds;
  Field speeds_without_friction, speeds_without_pressure;
  StressField stress_at_solids = make_stress_field(region);
  ProjectionReport report;
  Field impulse(faces), without_friction(faces), without_pressure(faces);
  Stopwatch watch;
  for (int n = 0; n < (cold ? settings.cold_iterations : settings.iterations); ++n) {
    impulse.setZero();
    add_gradient(region, stress.pressure, -1.0, impulse);
    cone.gap_tolerance =
        std::max(square(tolerance) * mass.sum(),
                 square(settings.relative_tolerance) * (impulse.square() * inverse_mass).sum());
    without_friction = free_velocity + inverse_mass * impulse;
    speeds_without_friction = free_speeds;
    bodies.add_pressure(stress.pressure, -1.0, speeds_without_friction);
    const Field confining = confining_pressure(region, state.fill, stress.pressure, free_velocity,
                                               velocity_scale, bodies, free_speeds);
    set_friction_radii(region, friction, state.friction, confining, stress.pressure, reaction, stress.copies,
                       balls);
    if (settings.record) {
      settings.record(ConeQp{"friction", sparse_friction(region, friction, bodies),
                             joined(mass.head(region.open_faces), bodies.inverse_mass()),
                             joined(without_friction.head(region.open_faces), speeds_without_friction), balls,
                             stress.copies, solver.lipschitz(), cone});
    }
    const auto frictional =
        solver.solve(balls, without_friction, speeds_without_friction, cone, stress.copies);
    report.seconds[Phase::friction] += watch.lap();

    friction.apply(stress.copies, impulse);
    without_pressure = free_velocity + inverse_mass * impulse;
    speeds_without_pressure = free_speeds;
    if (bodies.any()) {
      friction.stress_of(stress.copies, stress_at_solids);
      bodies.add_friction(stress_at_solids, speeds_without_pressure);
    }
    const auto packed = settings.pressure_pulls
                            ? pressure.solve_pulling(without_pressure, speeds_without_pressure, bound,
                                                     stress.pressure, settings.record)
                            : pressure.solve(without_pressure, speeds_without_pressure, room, bound,
                                             stress.pressure, settings.record);
    report.seconds[Phase::pressure] += watch.lap();

    report.friction_iterations += frictional.iterations;
    report.pressure_iterations += packed.iterations;
    report.cap_hits += !frictional.converged + !packed.converged;
    report.friction_residual = mass.sum() > 0.0 ? std::sqrt(frictional.gap / mass.sum()) : 0.0;
    report.pressure_residual = packed.residual;
  }
  impulse.setZero();
  add_gradient(region, stress.pressure, -1.0, impulse);
  velocity.head(faces) = without_pressure + inverse_mass * impulse;
  speeds = speeds_without_pressure;
  bodies.add_pressure(stress.pressure, -1.0, speeds);
  return report;
}

Stress zero_stress(const ActiveRegion& region) {
  const auto walls = static_cast<Eigen::Index>(region.wall_faces.size());
  return {Field::Zero(region.cell_count() + 1),
          Eigen::ArrayXd::Zero(values_per_cell * region.cell_count() + values_per_wall_face * walls +
                               values_per_contact * static_cast<Eigen::Index>(region.contacts.size()))};
}

Stress carry_over(const ActiveRegion& from, const Stress& stress, const ActiveRegion& to, double dt_ratio) {
  Stress carried = zero_stress(to);
  for (int cell = 0; cell < to.cell_count(); ++cell) {
    const int before =
        from.cell_of_dense[static_cast<std::size_t>(to.dense_of_cell[static_cast<std::size_t>(cell)])];
    if (before < 0) continue;
    carried.pressure[cell] = dt_ratio * stress.pressure[before];
    carried.copies.segment(values_per_cell * cell, values_per_cell) =
        dt_ratio * stress.copies.segment(values_per_cell * before, values_per_cell);
  }
  const Eigen::Index walls_from = values_per_cell * from.cell_count(),
                     walls_to = values_per_cell * to.cell_count();
  for (std::size_t w = 0; w < to.wall_faces.size(); ++w) {
    const WallFace& wall = to.wall_faces[w];
    Eigen::Vector3i place = to.grid.cell_of_index(to.dense_of_cell[static_cast<std::size_t>(wall.cell)]);
    if (wall.inward < 0.0) ++place[wall.axis];
    const auto dense = static_cast<std::size_t>(to.grid.face_index(wall.axis, place));
    const int before = from.face_of_dense[static_cast<std::size_t>(wall.axis)][dense] - from.open_faces - 1;
    if (before < 0) continue;
    carried.copies.segment(walls_to + values_per_wall_face * static_cast<Eigen::Index>(w),
                           values_per_wall_face) =
        dt_ratio * stress.copies.segment(walls_from + values_per_wall_face * before, values_per_wall_face);
  }
  const auto contact_values = [](const ActiveRegion& region) {
    return values_per_contact * static_cast<Eigen::Index>(region.contacts.size());
  };
  carry_over_contacts(from, stress.copies.tail(contact_values(from)), to, dt_ratio,
                      carried.copies.tail(contact_values(to)));
  return carried;
}

void carry_over_contacts(const ActiveRegion& from, const Eigen::Ref<const Field>& before,
                         const ActiveRegion& to, double dt_ratio, Eigen::Ref<Field> now) {
  std::vector<Eigen::Index> contact_of_cell(static_cast<std::size_t>(from.cell_count()), -1);
  for (std::size_t c = 0; c < from.contacts.size(); ++c)
    contact_of_cell[static_cast<std::size_t>(from.contacts[c].cell)] = static_cast<Eigen::Index>(c);
  for (std::size_t c = 0; c < to.contacts.size(); ++c) {
    const int cell = from.cell_of_dense[static_cast<std::size_t>(
        to.dense_of_cell[static_cast<std::size_t>(to.contacts[c].cell)])];
    const Eigen::Index contact = cell < 0 ? -1 : contact_of_cell[static_cast<std::size_t>(cell)];
    if (contact < 0) continue;
    now.segment<values_per_contact>(values_per_contact * static_cast<Eigen::Index>(c)) =
        dt_ratio * before.segment<values_per_contact>(values_per_contact * contact);
  }
}

}  // namespace talus
