#include "continuum/stress/packing.h"

#include "continuum/stress/pressure.h"
#include "continuum/stress/staggered_projections.h"

namespace talus {
namespace {

constexpr double largest_displacement_in_cells = 0.25;

}  // namespace

PackingResult correct_packing(const ActiveRegion& region, const PointsByCell& points,
                              std::span<const Material> materials, const BoundQpSettings& settings,
                              Particles& particles, const ProblemRecorder& record) {
  PackingResult result;
  const auto [fill, face_volume] = deposit_volume(region, points, particles, materials);
  result.peak_fill = fill.maxCoeff();
  result.bulk_volume = minimum_volumes(particles, materials).sum() -
                       ((fill - 1.0).max(0.0) * region.cell_kernel).sum() * region.grid.cell_volume();
  result.solve.converged = true;
  if (result.peak_fill <= 1.0 + settings.tolerance) return result;

  const double h = region.grid.spacing;
  const Eigen::Index faces = region.open_faces + 1;
  // Displacements in cells: a face's fill stands for its mass.
  Field inverse_fill = (face_volume.head(faces) / region.grid.cell_volume())
                           .max(smallest_face_fill * region.face_kernel)
                           .inverse();
  inverse_fill[region.null_face()] = 0.0;
  Field correction = Field::Zero(region.cell_count() + 1);
  result.solve = solve_pressure(region, inverse_fill, Field::Zero(faces), 1.0 - fill, settings, correction,
                                record, "packing");

  Field displacement = Field::Zero(region.face_count());
  Field open = Field::Zero(faces);
  add_gradient(region, correction, -1.0, open);
  displacement.head(faces) =
      h * (inverse_fill * open).max(-largest_displacement_in_cells).min(largest_displacement_in_cells);
  const Eigen::Matrix3Xd moved = interpolate(region, points, displacement, particles.positions);
  result.largest_displacement = moved.cwiseAbs().maxCoeff();
  particles.positions += moved;
  return result;
}

}  // namespace talus
