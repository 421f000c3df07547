// Face fields at particles, cell by cell and four particles at a time: the 18 faces around a cell along each axis are read
// once for all of its particles (ActiveRegion::cell_stencils).
//
// Along an axis on which the kernel is centred in cells, three rows take part, of which one has weight 0:
//   w(-1) = max(0, 1/2 - t),   w(1) = max(0, t - 1/2),   w(0) = 1 - w(-1) - w(1),   t the place within the cell.
#pragma once

#include <Eigen/Core>
#include <array>
#include <stdexcept>

#include "continuum/grid/active_region.h"
#include "continuum/grid/operators.h"
#include "continuum/particles/lanes.h"

namespace talus {

/// Weights of four particles; derivatives by place in cells.
struct KernelLanes {
  std::array<std::array<Lanes, 2>, 3> across;     // of a cell's lower and upper face
  std::array<std::array<Lanes, 3>, 3> row, rate;  // of the rows around it, and their derivatives
};

inline KernelLanes kernel_at(const std::array<Lanes, 3>& local) {
  KernelLanes kernel;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Lanes& t = local[axis];
    const Lanes upper = (2.0 * t).floor(), lower = 1.0 - upper;  // 1 where t is 1/2 or more
    kernel.across[axis] = {1.0 - t, t};
    const Lanes below = (0.5 - t).max(0.0), above = (t - 0.5).max(0.0);
    kernel.row[axis] = {below, 1.0 - below - above, above};
    kernel.rate[axis] = {-lower, lower - upper, upper};
  }
  return kernel;
}

/// The places within their cell of four particles.
inline std::array<Lanes, 3> local_places(const Grid& grid, const Eigen::Matrix3Xd& positions,
                                         const LaneParticles& particles) {
  std::array<Lanes, 3> local;
  for (int axis = 0; axis < 3; ++axis) {
    Lanes x;
    for (int lane = 0; lane < lane_count; ++lane)
      x[lane] = positions(axis, particles.index[static_cast<std::size_t>(lane)]);
    const Lanes scaled = (x - grid.origin[axis]) / grid.spacing;
    local[static_cast<std::size_t>(axis)] = scaled - scaled.floor();
  }
  return local;
}

/// A face field on the faces around a cell.
using CellFaces = std::array<std::array<double, 18>, 3>;

inline void read_faces(const CellStencil& stencil, const Field& faces, CellFaces& values) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t k = 0; k < 18; ++k) values[axis][k] = faces[stencil.faces[axis][k]];
  }
}

inline Lanes value_of(const std::array<double, 18>& faces, const KernelLanes& kernel, std::size_t axis) {
  const auto& next = kernel.row[(axis + 1) % 3];
  const auto& last = kernel.row[(axis + 2) % 3];
  std::array<Lanes, 2> side;
  for (std::size_t s = 0; s < 2; ++s) {
    side[s] = Lanes::Zero();
    for (std::size_t c = 0; c < 3; ++c) {
      const double* v = &faces[9 * s + 3 * c];
      side[s] += last[c] * (next[0] * v[0] + next[1] * v[1] + next[2] * v[2]);
    }
  }
  return kernel.across[axis][0] * side[0] + kernel.across[axis][1] * side[1];
}

/// The value, and its derivatives along the axis itself, its next and its last one, per cell.
struct ValueAndRates {
  Lanes value;
  std::array<Lanes, 3> rate;
};

inline ValueAndRates value_and_rates_of(const std::array<double, 18>& faces, const KernelLanes& kernel,
                                        std::size_t axis) {
  const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
  std::array<Lanes, 2> side, along_next, along_last;
  for (std::size_t s = 0; s < 2; ++s) {
    side[s] = along_next[s] = along_last[s] = Lanes::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const double* v = &faces[9 * s + 3 * k];
      const Lanes row = kernel.row[b][0] * v[0] + kernel.row[b][1] * v[1] + kernel.row[b][2] * v[2];
      side[s] += kernel.row[c][k] * row;
      along_last[s] += kernel.rate[c][k] * row;
      along_next[s] +=
          kernel.row[c][k] * (kernel.rate[b][0] * v[0] + kernel.rate[b][1] * v[1] + kernel.rate[b][2] * v[2]);
    }
  }
  const auto& across = kernel.across[axis];
  return {across[0] * side[0] + across[1] * side[1],
          {side[1] - side[0], across[0] * along_next[0] + across[1] * along_next[1],
           across[0] * along_last[0] + across[1] * along_last[1]}};
}

/// Calls use(particles, cell) for the particles of `points` in cells [begin, end) of it, by fours; `cell` is the region's.
template <class Use>
void for_each_four(const ActiveRegion& region, const PointsByCell& points, std::ptrdiff_t begin,
                   std::ptrdiff_t end, const Use& use) {
  for (auto c = static_cast<std::size_t>(begin); c < static_cast<std::size_t>(end); ++c) {
    const int cell = region.cell_of_dense[static_cast<std::size_t>(points.cells[c])];
    for (int place = points.first[c]; place < points.first[c + 1]; place += lane_count) {
      LaneParticles four{{}, std::min(lane_count, points.first[c + 1] - place)};
      for (int lane = 0; lane < lane_count; ++lane)
        four.index[static_cast<std::size_t>(lane)] = points.point(place + std::min(lane, four.count - 1));
      use(four, cell);
    }
  }
}

/// Particles are where the region is. Throws std::invalid_argument where one lies outside its cells.
void require_inside(const ActiveRegion& region, const PointsByCell& points, Eigen::Index count);

}  // namespace talus
