#include "continuum/stress/pressure.h"

#include <limits>

#include "continuum/stress/assemble.h"

namespace talus {

PressureSolver::PressureSolver(const ActiveRegion& region, const Field& inverse_mass,
                               const BodyCoupling& bodies)
    : region_(region),
      inverse_mass_(inverse_mass),
      bodies_(bodies),
      cells_(make_cell_levels(region)),
      laplacian_(make_cell_laplacian(region, cells_, inverse_mass, bodies)),
      multigrid_(cells_, laplacian_),
      work_(region.cell_count()),
      transposed_(region.cell_count() + 1),
      linear_(region.cell_count()) {}

BoundQp PressureSolver::problem(const char* name, const Field& linear, const Field& start,
                                const BoundQpSettings& settings) const {
  Eigen::SparseMatrix<double> matrix =
      normal_matrix(sparse_gradient(region_), inverse_mass_.head(region_.open_faces));
  double norm = 2.0;  // Gershgorin: a diagonally scaled graph Laplacian has its spectrum in [0, 2]
  if (bodies_.any()) {
    const Eigen::SparseMatrix<double> modes = bodies_.pressure_modes();
    matrix += Eigen::SparseMatrix<double>(modes * modes.transpose());
    norm = scaled_norm_bound(matrix);
  }
  const Eigen::Index n = region_.cell_count();
  Field upper(n);
  for (Eigen::Index cell = 0; cell < n; ++cell) {
    const bool moves = laplacian_.inverse_diagonal[cells_.order[static_cast<std::size_t>(cell)]] > 0.0;
    upper[cell] = moves ? std::numeric_limits<double>::infinity() : 0.0;
  }
  return {name, matrix, linear, Field::Zero(n), upper, start, norm, settings};
}

BoundQpResult PressureSolver::solve(const Field& free_velocity, const Field& room,
                                    const BoundQpSettings& settings, Field& pressure,
                                    const ProblemRecorder& record, const char* name) {
  return solve(free_velocity, Field::Zero(bodies_.inverse_mass().size()), room, settings, pressure, record,
               name);
}

BoundQpResult PressureSolver::solve(const Field& free_velocity, const Field& free_speeds, const Field& room,
                                    const BoundQpSettings& settings, Field& pressure,
                                    const ProblemRecorder& record, const char* name) {
  const Eigen::Index n = region_.cell_count();
  gradient_transpose(region_, free_velocity, transposed_);
  bodies_.add_compression(free_speeds, transposed_);
  linear_ = (room * region_.cell_share).head(n) - transposed_.head(n);
  if (record) record(problem(name, linear_, pressure.head(n), settings));
  for (Eigen::Index cell = 0; cell < n; ++cell) {
    const int place = cells_.order[static_cast<std::size_t>(cell)];
    work_.linear[place] = linear_[cell];
    work_.x[place] = std::max(0.0, pressure[cell]);
  }
  const BoundQpResult result = minimise_nonnegative(cells_, laplacian_, settings, multigrid_, work_);
  for (Eigen::Index cell = 0; cell < n; ++cell)
    pressure[cell] = work_.x[cells_.order[static_cast<std::size_t>(cell)]];
  return result;
}

BoundQpResult PressureSolver::solve_pulling(const Field& free_velocity, const Field& free_speeds,
                                            const BoundQpSettings& settings, Field& pressure,
                                            const ProblemRecorder& record) {
  const Eigen::Index n = region_.cell_count();
  gradient_transpose(region_, free_velocity, transposed_);
  bodies_.add_compression(free_speeds, transposed_);
  BoundQp liquid = problem("pressure", -transposed_.head(n), pressure.head(n), settings);
  liquid.lower = -liquid.upper;  // 0 in cells that nothing moves with
  if (record) record(liquid);
  const BoundQpSolution solution = talus::solve(liquid);
  pressure.head(n) = solution.x;
  return solution.result;
}

BoundQpResult solve_pressure(const ActiveRegion& region, const Field& inverse_mass,
                             const Field& free_velocity, const Field& room, const BoundQpSettings& settings,
                             Field& pressure, const ProblemRecorder& record, const char* name) {
  return PressureSolver(region, inverse_mass).solve(free_velocity, room, settings, pressure, record, name);
}

}  // namespace talus
