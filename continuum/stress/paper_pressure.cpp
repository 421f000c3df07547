#include "continuum/stress/paper_pressure.h"

#include <limits>

#include "continuum/stress/assemble.h"

namespace talus {

BoundQpResult solve_pressure_by_mprgp(const ActiveRegion& region, const Field& inverse_mass,
                                      const Field& free_velocity, const Field& room,
                                      const BoundQpSettings& settings, Field& pressure,
                                      const ProblemRecorder& record, const char* name,
                                      const BodyCoupling& bodies, const Field& free_speeds) {
  const Eigen::Index n = region.cell_count();
  Field cells = Field::Zero(n + 1), faces = Field::Zero(region.open_faces + 1),
        transposed = Field::Zero(n + 1), speeds = Field::Zero(bodies.inverse_mass().size());
  const auto apply = [&](const Field& p, Field& product) {
    cells.head(n) = p;
    faces.setZero();
    add_gradient(region, cells, 1.0, faces);
    faces *= inverse_mass;
    gradient_transpose(region, faces, transposed);
    if (bodies.any()) {
      speeds.setZero();
      bodies.add_pressure(cells, 1.0, speeds);
      bodies.add_compression(speeds, transposed);
    }
    product = transposed.head(n);
  };
  Field diagonal = Field::Zero(n);
  for (int f = 0; f < region.open_faces; ++f) {
    const auto [below, above] = region.face_cells[static_cast<std::size_t>(f)];
    if (below == above) continue;  // a periodic axis one cell long: no gradient across it
    const double curvature = region.face_area[f] * region.face_area[f] * inverse_mass[f];
    if (below != region.null_cell()) diagonal[below] += curvature;
    if (above != region.null_cell()) diagonal[above] += curvature;
  }
  // A cell walled in on every side has no face to move; its pressure does nothing and is left at zero.
  const double smallest = 1e-12 * diagonal.maxCoeff();
  const Field upper = (diagonal > smallest).select(std::numeric_limits<double>::infinity(), Field::Zero(n));
  diagonal = diagonal.max(std::max(smallest, std::numeric_limits<double>::min()));

  gradient_transpose(region, free_velocity, transposed);
  bodies.add_compression(free_speeds, transposed);
  const Field b = (room * region.cell_share).head(n) - transposed.head(n);
  double norm = 2.0;  // Gershgorin: a diagonally scaled graph Laplacian has its spectrum in [0, 2]
  Eigen::SparseMatrix<double> of_bodies(n, n);
  if (bodies.any()) {
    const Eigen::SparseMatrix<double> modes = bodies.pressure_modes();
    of_bodies = modes * modes.transpose();
    // Its row sums on the diagonal: what is scaled by them has its spectrum in [0, 2] still.
    for (int column = 0; column < of_bodies.outerSize(); ++column) {
      for (Eigen::SparseMatrix<double>::InnerIterator entry(of_bodies, column); entry; ++entry)
        diagonal[entry.row()] += std::abs(entry.value());
    }
  }
  Field x = pressure.head(n);
  if (record) {
    Eigen::SparseMatrix<double> matrix =
        normal_matrix(sparse_gradient(region), inverse_mass.head(region.open_faces));
    matrix += of_bodies;
    if (bodies.any()) norm = scaled_norm_bound(matrix);
    record(BoundQp{name, matrix, b, Field::Zero(n), upper, x, norm, settings});
  }
  const auto result = minimise_bound_qp(apply, b, Field::Zero(n), upper, diagonal, norm, settings, x);
  pressure.head(n) = x;
  return result;
}

}  // namespace talus
