// Tables of the pressure solve on collapses under way: iterations and time, by multigrid and by MPRGP. Run by hand.
//
//   pressure_study         16 to 64 cells across in plane strain, 8 and 16 in 3-D: about a minute
//   pressure_study large   128 across, and 32 in 3-D: several minutes
#include <fmt/format.h>

#include <ctime>
#include <string>

#include "continuum/stress/pressure.h"
#include "continuum/stress/staggered_projections.h"
#include "tests/continuum/scenes.h"

namespace {

using namespace talus;

constexpr double column_height = 0.1;  // m

/// What the first pressure solve of the next step, and the density correction, are given.
struct Moment {
  ActiveRegion region;
  Field inverse_mass, velocity, room, pressure;
  Field inverse_fill, excess;
  double tolerance;  // m/s
};

Moment moment_of(const State& state) {
  Moment m{make_active_region(state.grid, state.sides, state.particles.positions, state.openings),
           {},
           {},
           {},
           {},
           {},
           {},
           0.0};
  const ActiveRegion& region = m.region;
  const double h = region.grid.spacing,
               dt = state.warm ? state.warm->dt : 0.25 * std::sqrt(h / testing::gravity);
  const GridState grid = deposit(region, state.particles, state.materials,
                                 Eigen::ArrayXd::Constant(state.particles.count(), 0.4));
  const Eigen::Index faces = region.open_faces + 1;
  const Field fill = grid.face_volume.head(faces) / region.grid.cell_volume();
  m.inverse_fill = fill.max(smallest_face_fill).inverse();
  m.inverse_fill[region.null_face()] = 0.0;
  m.inverse_mass = (grid.face_mass.head(faces) > 0.0)
                       .select(fill * m.inverse_fill / grid.face_mass.head(faces).max(1e-300), 0.0);
  m.velocity = grid.velocity.head(faces);
  for (int f = 0; f < region.open_faces; ++f)
    m.velocity[f] += dt * state.gravity[region.face_axis[static_cast<std::size_t>(f)]];
  Stress stress = zero_stress(region);
  if (state.warm) {
    stress = carry_over(state.warm->region, std::get<Stress>(state.warm->stress), region, 1.0);
    const FrictionOperator friction(region);
    friction.clear_idle(stress.copies);
    Field impulse = Field::Zero(faces);
    friction.apply(stress.copies, impulse);
    m.velocity += m.inverse_mass * impulse;
  }
  m.pressure = stress.pressure;
  m.room = (packed_fill - grid.fill).max(0.0) * (h / dt);
  m.excess = 1.0 - deposit_fill(region, state.particles, state.materials);
  m.tolerance = 0.01 * testing::gravity * dt;
  return m;
}

double cpu_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void print_row(const std::string& scene, const char* kind, const Moment& m, bool packing,
               const Field& start) {
  const BoundQpSettings settings{packing ? 0.005 : m.tolerance, 5000};
  const Field velocity = packing ? Field(Field::Zero(m.velocity.size())) : m.velocity;
  const Field &mass = packing ? m.inverse_fill : m.inverse_mass, &room = packing ? m.excess : m.room;
  BoundQp problem;
  Field pressure = start;
  solve_pressure(m.region, mass, velocity, room, settings, pressure,
                 [&](const Problem& given) { problem = std::get<BoundQp>(given); });
  const double begin = cpu_ms();
  const BoundQpSolution mprgp = solve(problem);
  const double before_setup = cpu_ms();
  PressureSolver solver(m.region, mass);
  const double before_solve = cpu_ms();
  pressure = start;
  const BoundQpResult result = solver.solve(velocity, room, settings, pressure);
  const double end = cpu_ms();
  fmt::print("| {} | {} | {} | {}{} | {:.2f} | {}{} | {:.2f} + {:.2f} |\n", scene, m.region.cell_count(),
             kind, mprgp.result.iterations, mprgp.result.converged ? "" : " (cap)", before_setup - begin,
             result.iterations, result.converged ? "" : " (cap)", before_solve - before_setup,
             end - before_solve);
  std::fflush(stdout);
}

/// A column of `cells`, one cell across meaning plane strain, in the middle of an open floor three times as long.
State column(const Eigen::Vector3i& cells) {
  const double h = column_height / cells[2];
  const bool plane = cells[1] == 1;
  const Eigen::Vector3i domain(3 * cells[0], plane ? 1 : 3 * cells[1], cells[2] + 2);
  Scene scene = testing::box_scene(domain, cells.cast<double>(), h, 0.4);
  const Eigen::Vector3d from(h * cells[0], plane ? 0.0 : h * cells[1], 0.0);
  scene.fillings = {testing::box_of(0, from, from + h * cells.cast<double>())};
  scene.grid.periodic[1] = plane;
  if (plane) scene.particles_per_cell = {2, 1, 2};
  scene.sides[2][0] = {true, 0.4};
  scene.jitter = 0.5;
  return initial_state(scene);
}

void study(const Eigen::Vector3i& cells) {
  State state = column(cells);
  StepSettings settings;
  settings.projection.max_friction_iterations = 60;  // the friction is not what is measured
  const std::string name = fmt::format("{} x {} x {}", cells[0], cells[1], cells[2]);
  for (const double time : {0.0, 0.3, 1.0, 2.0}) {  // sqrt(height / g)
    testing::run_for(state, settings, time * std::sqrt(column_height / testing::gravity) - state.time,
                     [](const State&, const StepReport&) {});
    const Moment m = moment_of(state);
    const Field zero = Field::Zero(m.pressure.size());
    const std::string scene = fmt::format("{}, t = {}", name, time);
    if (time > 0.0) print_row(scene, "warm", m, false, m.pressure);
    print_row(scene, "cold", m, false, zero);
    print_row(scene, "packing", m, true, zero);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool large = argc > 1 && std::string(argv[1]) == "large";
  fmt::print(
      "| column, time / sqrt(H/g) | cells | solve | MPRGP iterations | ms | multigrid iterations | setup + "
      "solve, ms "
      "|\n|---|---|---|---|---|---|---|\n");
  const std::vector<Eigen::Vector3i> sizes =
      large ? std::vector<Eigen::Vector3i>{{128, 1, 128}, {32, 32, 32}}
            : std::vector<Eigen::Vector3i>{{16, 1, 16}, {32, 1, 32}, {64, 1, 64}, {8, 8, 8}, {16, 16, 16}};
  for (const auto& cells : sizes) study(cells);
}
