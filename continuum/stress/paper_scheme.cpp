#include "continuum/stress/paper_scheme.h"

#include "continuum/stress/paper_friction.h"
#include "continuum/stress/paper_pressure.h"

namespace talus {
namespace {

/// (phi/rho) / h^3 of each open face, 1/kg: what a unit impulse adds to its flux.
Field inverse_flux_mass(const ActiveRegion& region, const GridState& state) {
  const Field mass = state.face_mass.head(region.open_faces + 1);
  const Field volume = state.face_volume.head(region.open_faces + 1);
  Field inverse =
      (mass > 0.0).select(volume / (mass.max(1e-300) * region.grid.cell_volume() * region.face_kernel), 0.0);
  inverse[region.null_face()] = 0.0;
  return inverse;
}

void stop_at_walls(const ActiveRegion& region, Field& velocity) {
  for (const WallFace& wall : region.wall_faces)
    velocity[wall.face] = wall.inward * std::max(0.0, wall.inward * velocity[wall.face]);
}

}  // namespace

ProjectionReport project(const ActiveRegion& region, const GridState& state, double dt, double velocity_scale,
                         int up, const ProjectionSettings& settings, const BodyCoupling& bodies,
                         PaperStress& stress, Field& velocity, Field& speeds) {
  const Eigen::Index faces = region.open_faces + 1;
  const double tolerance = settings.tolerance * velocity_scale;
  stop_at_walls(region, velocity);
  const Field face_fill = state.face_volume.head(faces) / (region.grid.cell_volume() * region.face_kernel);
  const Field free_flux = face_fill * velocity.head(faces);
  const Field inverse_mass = inverse_flux_mass(region, state);
  const Field room = (1.0 - state.fill).max(0.0) * (region.grid.spacing / dt);

  PaperFriction friction(region, inverse_mass, up, settings.record);
  ProjectionReport report;
  Field impulse(faces), flux = free_flux;
  const auto with_pressure = [&](const Field& without) {
    impulse.setZero();
    add_gradient(region, stress.pressure, -1.0, impulse);
    return Field(without + inverse_mass * impulse);
  };
  const Field free_speeds = speeds;
  Stopwatch watch;
  for (int n = 0; n < settings.iterations; ++n) {
    if (bodies.any()) {
      speeds = free_speeds;
      bodies.add_pressure(stress.pressure, -1.0, speeds);
      StressField strain = make_stress_field(region);
      bodies.add_strain(speeds, strain);
      friction.move_bodies(std::move(strain));
    }
    const auto frictional =
        friction.solve(with_pressure(free_flux), friction_box(region, state.friction, stress.pressure),
                       {tolerance, settings.max_friction_iterations}, stress.friction);
    report.seconds[Phase::friction] += watch.lap();
    flux = friction.flux(free_flux, stress.friction);
    speeds = free_speeds;
    bodies.add_friction(stress.friction, speeds);
    const auto packed = solve_pressure_by_mprgp(region, inverse_mass, flux, room,
                                                {tolerance, settings.max_pressure_iterations},
                                                stress.pressure, settings.record, "pressure", bodies, speeds);
    report.seconds[Phase::pressure] += watch.lap();
    flux = with_pressure(flux);
    bodies.add_pressure(stress.pressure, -1.0, speeds);

    report.friction_iterations += frictional.iterations;
    report.pressure_iterations += packed.iterations;
    report.cap_hits += frictional.unconverged + !packed.converged;
    report.friction_residual = frictional.residual;
    report.pressure_residual = packed.residual;
  }
  velocity.head(faces) += (flux - free_flux) / face_fill.max(smallest_face_fill);
  return report;
}

PaperStress zero_paper_stress(const ActiveRegion& region) {
  return {Field::Zero(region.cell_count() + 1), make_stress_field(region)};
}

PaperStress carry_over(const ActiveRegion& from, const PaperStress& stress, const ActiveRegion& to,
                       double dt_ratio) {
  PaperStress carried = zero_paper_stress(to);
  for (int cell = 0; cell < to.cell_count(); ++cell) {
    const int before =
        from.cell_of_dense[static_cast<std::size_t>(to.dense_of_cell[static_cast<std::size_t>(cell)])];
    if (before < 0) continue;
    carried.pressure[cell] = dt_ratio * stress.pressure[before];
    carried.friction.diagonal.col(cell) = dt_ratio * stress.friction.diagonal.col(before);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t dense = 0; dense < to.edge_of_dense[axis].size(); ++dense) {
      const int now = to.edge_of_dense[axis][dense], before = from.edge_of_dense[axis][dense];
      if (now >= 0 && before >= 0) carried.friction.shear[now] = dt_ratio * stress.friction.shear[before];
    }
  }
  carry_over_contacts(from, stress.friction.contact, to, dt_ratio, carried.friction.contact);
  return carried;
}

}  // namespace talus
