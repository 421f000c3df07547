#include "tests/continuum/qp/collapse_problems.h"

#include <limits>
#include <stdexcept>

#include "continuum/stress/assemble.h"
#include "continuum/stress/friction.h"
#include "tests/continuum/scenes.h"

namespace talus::testing {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

constexpr double tolerance = 0.01;  // of a run, in units of g dt
constexpr int max_iterations = 2000;
constexpr double laplacian_norm = 2.0;

Field face_fill(const CollapseMoment& moment) {
  const ActiveRegion& region = moment.region;
  return moment.grid.face_volume.head(region.open_faces) / region.grid.cell_volume();
}

/// Cells without a face to move keep their pressure at zero.
BoundQp one_sided(const char* name, const SparseMatrix& matrix, const Field& linear, const Field& start,
                  double within) {
  const Field upper = (matrix.diagonal().array() > 0.0)
                          .select(std::numeric_limits<double>::infinity(), Field::Zero(matrix.rows()));
  return {name,  matrix, linear,         Field::Zero(matrix.rows()),
          upper, start,  laplacian_norm, {within, max_iterations}};
}

Field with_null(const Field& faces) {
  Field field = Field::Zero(faces.size() + 1);
  field.head(faces.size()) = faces;
  return field;
}

}  // namespace

const Problem& BodyStep::last(const std::string& name) const {
  for (auto problem = problems.rbegin(); problem != problems.rend(); ++problem) {
    if (std::visit([](const auto& qp) { return qp.name; }, *problem) == name) return *problem;
  }
  throw std::out_of_range(name);
}

BodyStep step_with_bodies(double tolerance) {
  constexpr double h = 0.01;
  Scene scene = box_scene({4, 3, 7}, {4.0, 3.0, 2.0}, h, 0.5);
  scene.sides[0] = {Side{true, 0.3}, Side{true, 0.0}};
  scene.sides[1] = {Side{true, 0.3}, Side{true, 0.0}};
  scene.sides[2][0] = {true, 0.4};
  scene.jitter = 0.5;
  State state = initial_state(scene);
  Body ball =
      make_body("ball", Shape{Sphere{h * Eigen::Vector3d(1.2, 1.5, 3.1), 1.2 * h}}, 3000.0, Free{}, {});
  Body post = make_body("post", Shape{Sphere{h * Eigen::Vector3d(3.3, 1.5, 1.5), 0.7 * h}}, 8000.0,
                        Prescribed{.twist = {.angular_velocity = {0.0, 0.0, 5.0}}}, {});
  ball.friction = 0.4;
  post.friction = 0.6;
  add_bodies(state, {ball, post});
  StepSettings settings;
  for (int i = 0; i < 12; ++i) step(state, settings, 1.0);
  BodyStep recorded;
  settings.projection.tolerance = tolerance;
  settings.projection.max_friction_iterations = settings.projection.max_pressure_iterations = 20000;
  settings.projection.record = [&](const Problem& problem) { recorded.problems.push_back(problem); };
  const StepReport report = step(state, settings, 1.0);
  if (report.cap_hits() > 0) throw std::logic_error("unconverged solves");
  if (report.on_bodies[0].linear[2] <= 0.0) throw std::logic_error("the sand does not hold the ball");
  recorded.stress = std::get<Stress>(state.warm->stress);
  return recorded;
}

CollapseMoment collapse_moment(const Eigen::Vector3i& cells, int steps) {
  Scene scene = box_scene({3 * cells[0], cells[1], cells[2] + 2}, cells.cast<double>(), 0.01, 0.5);
  scene.grid.periodic[1] = cells[1] == 1;
  scene.sides[0] = {Side{true, 0.0}, Side{true, 0.0}};
  scene.sides[1] = {Side{true, 0.3}, Side{true, 0.0}};
  scene.sides[2][0] = {true, 0.4};
  scene.jitter = 0.5;
  State state = initial_state(scene);
  for (int i = 0; i < steps; ++i) step(state, StepSettings{}, 1.0);
  return moment_of(state);
}

CollapseMoment moment_of(const State& state) {
  CollapseMoment moment{
      make_active_region(state.grid, state.sides, state.particles.positions), {}, {}, {}, {}, state.warm->dt};
  const ActiveRegion& region = moment.region;
  moment.grid = deposit(region, state.particles, state.materials,
                        Eigen::ArrayXd::Constant(state.particles.count(), 0.5));
  moment.stress = carry_over(state.warm->region, std::get<Stress>(state.warm->stress), region, 1.0);
  const Field fill = face_fill(moment), mass = moment.grid.face_mass.head(region.open_faces);
  moment.inverse_mass = (mass > 0.0).select(fill / (mass * fill.max(smallest_face_fill)).max(1e-300), 0.0);
  moment.velocity = moment.grid.velocity.head(region.open_faces);
  for (int face = 0; face < region.open_faces; ++face)
    moment.velocity[face] += moment.dt * state.gravity[region.face_axis[static_cast<std::size_t>(face)]];
  return moment;
}

BoundQp pressure_problem(const CollapseMoment& moment, const Field& velocity) {
  const SparseMatrix gradient = sparse_gradient(moment.region);
  const Eigen::Index n = moment.region.cell_count();
  const Field room =
      (packed_fill - moment.grid.fill.head(n)).max(0.0) * (moment.region.grid.spacing / moment.dt);
  return one_sided("pressure", normal_matrix(gradient, moment.inverse_mass),
                   room - (gradient.transpose() * velocity.matrix()).array(), moment.stress.pressure.head(n),
                   tolerance * gravity * moment.dt);
}

BoundQp packing_problem(const CollapseMoment& moment, std::mt19937_64& random) {
  std::uniform_real_distribution<double> fill(0.8, 1.6);
  const Eigen::Index n = moment.region.cell_count();
  const Field room = 1.0 - Field::NullaryExpr(n, [&] { return fill(random); });
  return one_sided(
      "packing",
      normal_matrix(sparse_gradient(moment.region), face_fill(moment).max(smallest_face_fill).inverse()),
      room, Field::Zero(n), StepSettings{}.packing_tolerance);
}

BoundQp shear_problem(const CollapseMoment& moment, int axis) {
  const ActiveRegion& region = moment.region;
  std::vector<Eigen::Triplet<double>> selected;
  std::vector<double> strength;
  for (int edge = 0; edge < region.inner_edges; ++edge) {
    const auto e = static_cast<std::size_t>(edge);
    if (region.edge_axis[e] != axis) continue;
    double sum = 0.0;
    for (const int copy : region.edge_copies[e]) {
      if (copy < 0) continue;
      const int cell = copy / copies_per_cell;
      sum += moment.grid.friction[cell] * moment.stress.pressure[cell];
    }
    selected.emplace_back(edge, static_cast<int>(strength.size()), 1.0);
    strength.push_back(sum / 4.0);
  }
  const auto n = static_cast<Eigen::Index>(strength.size());
  SparseMatrix selection(region.edge_count(), n);
  selection.setFromTriplets(selected.begin(), selected.end());
  const SparseMatrix divergence = sparse_shear_divergence(region) * selection;
  const SparseMatrix matrix = normal_matrix(divergence, moment.inverse_mass);
  const Field upper = Eigen::Map<const Field>(strength.data(), n);
  Field pushed = with_null(Field::Zero(region.open_faces));
  add_gradient(region, moment.stress.pressure, -1.0, pushed);
  const Field velocity = moment.velocity + moment.inverse_mass * pushed.head(region.open_faces);
  return {"shear",
          matrix,
          (divergence.transpose() * velocity.matrix()).array(),
          -upper,
          upper,
          Field::Zero(n),
          scaled_norm_bound(matrix),
          {tolerance * gravity * moment.dt, max_iterations}};
}

ConeQp friction_problem(const CollapseMoment& moment) {
  const ActiveRegion& region = moment.region;
  const FrictionOperator friction(region);
  Eigen::ArrayXd copies = moment.stress.copies;
  friction.clear_idle(copies);
  BallBlocks balls = friction.blocks(with_null(moment.inverse_mass));
  const auto walls = static_cast<Eigen::Index>(region.wall_faces.size());
  set_friction_radii(region, friction, moment.grid.friction, moment.stress.pressure, moment.stress.pressure,
                     Eigen::ArrayXd::Zero(walls), copies, balls);
  Field pushed = with_null(Field::Zero(region.open_faces));
  add_gradient(region, moment.stress.pressure, -1.0, pushed);
  const Field mass = (moment.inverse_mass > 0.0).select(moment.inverse_mass.max(1e-300).inverse(), 0.0);
  const double within = tolerance * gravity * moment.dt;
  return {"friction",
          sparse_friction(region, friction),
          mass,
          moment.velocity + moment.inverse_mass * pushed.head(region.open_faces),
          balls,
          copies,
          smallest_lipschitz,
          {within * within * mass.sum(), max_iterations}};
}

}  // namespace talus::testing
