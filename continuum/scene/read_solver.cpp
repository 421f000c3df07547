#include "continuum/scene/read_solver.h"

#include <array>
#include <limits>

namespace talus {
namespace {

Scheme read_scheme(const CheckedTable& solver, Scheme otherwise) {
  constexpr std::array<std::string_view, 2> schemes{"consistent", "paper"};
  if (!solver.has("scheme")) return otherwise;
  return solver.choice("scheme", schemes) == "paper" ? Scheme::paper : Scheme::consistent;
}

void read_projection(const CheckedTable& solver, ProjectionSettings& p) {
  p.iterations = static_cast<int>(solver.integer("iterations", 1, 100, p.iterations));
  p.cold_iterations = static_cast<int>(solver.integer("cold_iterations", 1, 100, p.cold_iterations));
  p.tolerance = solver.number("tolerance", {1e-12, 1.0}, p.tolerance);
  p.relative_tolerance = solver.number("relative_tolerance", {0.0, 1.0}, p.relative_tolerance);
  p.max_pressure_iterations =
      static_cast<int>(solver.integer("max_pressure_iterations", 1, 1'000'000, p.max_pressure_iterations));
  p.max_friction_iterations =
      static_cast<int>(solver.integer("max_friction_iterations", 1, 1'000'000, p.max_friction_iterations));
}

std::string read_broken(const CheckedTable& solver, StepSettings& settings) {
  constexpr std::array<std::string_view, 2> defects{"pressure_pulls", "no_density_correction"};
  if (!solver.has("broken")) return {};
  std::string broken = solver.choice("broken", defects);
  if (settings.scheme == Scheme::paper)
    throw solver.error("broken", "breaks the consistent scheme only; remove this, or scheme = \"paper\"");
  if (broken == "pressure_pulls") settings.projection.pressure_pulls = true;
  // No fill is above that: the correction then only measures.
  if (broken == "no_density_correction") settings.packing_tolerance = std::numeric_limits<double>::infinity();
  return broken;
}

}  // namespace

std::string read_solver(const CheckedTable& solver, StepSettings& settings) {
  settings.scheme = read_scheme(solver, settings.scheme);
  read_projection(solver, settings.projection);
  settings.pic_share = solver.number("pic_share", {0.0, 1.0}, settings.pic_share);
  constexpr double smallest_courant_factor = 1e-3;  // below it a run of seconds takes days
  const double factor = solver.number("courant_factor", {smallest_courant_factor, 1.0}, 1.0);
  settings.courant *= factor;
  settings.gravity_courant *= factor;
  std::string broken = read_broken(solver, settings);
  solver.finish();
  return broken;
}

}  // namespace talus
