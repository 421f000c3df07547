// The grid to the particles; deposit.cpp has the other way.
#include "continuum/particles/transfer.h"

#include "continuum/parallel.h"
#include "continuum/particles/gather.h"

namespace talus {
namespace {

constexpr std::ptrdiff_t cells_in_block = 128;

}  // namespace

void require_inside(const ActiveRegion& region, const PointsByCell& points, Eigen::Index count) {
  bool inside = points.point_count() == count;
  for (const int dense : points.cells)
    inside = inside && region.cell_of_dense[static_cast<std::size_t>(dense)] >= 0;
  if (!inside) throw std::invalid_argument("a particle lies outside of the active region");
}

Eigen::ArrayXd minimum_volumes(const Particles& particles, std::span<const Material> materials) {
  Eigen::ArrayXd volumes = particles.masses;
  for (Eigen::Index p = 0; p < volumes.size(); ++p)
    volumes[p] /=
        materials[static_cast<std::size_t>(particles.materials[static_cast<std::size_t>(p)])].max_density();
  return volumes;
}

Eigen::Matrix3Xd interpolate(const ActiveRegion& region, const PointsByCell& points, const Field& faces,
                             const Eigen::Matrix3Xd& positions) {
  require_inside(region, points, positions.cols());
  Eigen::Matrix3Xd values(3, positions.cols());
  for_each_block(points.cell_count(), cells_in_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    CellFaces around;
    int read = -1;
    for_each_four(region, points, begin, end, [&](const LaneParticles& four, int cell) {
      if (cell != read) read_faces(region.cell_stencils[static_cast<std::size_t>(cell)], faces, around);
      read = cell;
      const KernelLanes kernel = kernel_at(local_places(region.grid, positions, four));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const Lanes value = value_of(around[axis], kernel, axis);
        for (int lane = 0; lane < four.count; ++lane)
          values(static_cast<int>(axis), four.index[static_cast<std::size_t>(lane)]) = value[lane];
      }
    });
  });
  return values;
}

Eigen::Matrix<double, 9, Eigen::Dynamic> interpolate_gradient(const ActiveRegion& region, const Field& faces,
                                                              const Eigen::Matrix3Xd& positions) {
  const PointsByCell points = points_by_cell(region.grid, positions);
  require_inside(region, points, positions.cols());
  Eigen::Matrix<double, 9, Eigen::Dynamic> gradients(9, positions.cols());
  for_each_block(points.cell_count(), cells_in_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    CellFaces around;
    int read = -1;
    for_each_four(region, points, begin, end, [&](const LaneParticles& four, int cell) {
      if (cell != read) read_faces(region.cell_stencils[static_cast<std::size_t>(cell)], faces, around);
      read = cell;
      const KernelLanes kernel = kernel_at(local_places(region.grid, positions, four));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const ValueAndRates found = value_and_rates_of(around[axis], kernel, axis);
        for (std::size_t k = 0; k < 3; ++k) {
          const auto row = static_cast<Eigen::Index>(axis + 3 * ((axis + k) % 3));
          for (int lane = 0; lane < four.count; ++lane)
            gradients(row, four.index[static_cast<std::size_t>(lane)]) =
                found.rate[k][lane] / region.grid.spacing;
        }
      }
    });
  });
  return gradients;
}

Eigen::Matrix3Xd interpolate(const ActiveRegion& region, const Field& faces,
                             const Eigen::Matrix3Xd& positions) {
  return interpolate(region, points_by_cell(region.grid, positions), faces, positions);
}

}  // namespace talus
