#include "continuum/stress/scheme.h"

#include "continuum/stress/paper_friction.h"

namespace talus {

SchemeStress zero_stress(Scheme scheme, const ActiveRegion& region) {
  if (scheme == Scheme::paper) return zero_paper_stress(region);
  return zero_stress(region);
}

SchemeStress carry_over(Scheme scheme, const ActiveRegion& from, const SchemeStress& stress,
                        const ActiveRegion& to, double dt_ratio) {
  const auto carry = [&](const auto& its) -> SchemeStress { return carry_over(from, its, to, dt_ratio); };
  const bool same = std::holds_alternative<PaperStress>(stress) == (scheme == Scheme::paper);
  return same ? std::visit(carry, stress) : zero_stress(scheme, to);
}

const Field& pressure_of(const SchemeStress& stress) {
  return std::visit([](const auto& its) -> const Field& { return its.pressure; }, stress);
}

StressField friction_of(const SchemeStress& stress, const ActiveRegion& region) {
  if (const auto* paper = std::get_if<PaperStress>(&stress)) return paper->friction;
  StressField friction = make_stress_field(region);
  FrictionOperator(region).stress_of(std::get<Stress>(stress).copies, friction);
  return friction;
}

ProjectionReport project(const ActiveRegion& region, const GridState& state, double dt,
                         const Eigen::Vector3d& gravity, double velocity_scale, bool cold,
                         const ProjectionSettings& settings, FrictionSolver& solver,
                         const BodyCoupling& bodies, SchemeStress& stress, Field& velocity, Field& speeds) {
  if (auto* paper = std::get_if<PaperStress>(&stress))
    return project(region, state, dt, velocity_scale, up_axis(gravity), settings, bodies, *paper, velocity,
                   speeds);
  return project(region, state, dt, velocity_scale, cold, settings, solver, bodies, std::get<Stress>(stress),
                 velocity, speeds);
}

}  // namespace talus
