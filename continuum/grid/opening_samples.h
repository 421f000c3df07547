// What openings.cpp and kernel_shares.cpp share: boxes of cells, and the samples that volume shares are measured with.
#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "continuum/grid/openings.h"

namespace talus {

inline constexpr int samples_per_axis = 4;  // per cell, for volume shares

/// Corners are counted at both ends of every axis, periodic or not.
inline int corner_index(const Grid& grid, const Eigen::Vector3i& i) {
  return i[0] + (grid.cells[0] + 1) * (i[1] + (grid.cells[1] + 1) * i[2]);
}

/// Cells from `lower` up to and without `upper`; of the rows that stick out of the domain, those along periodic axes stand for
/// the rows at the other end.
struct CellBox {
  Eigen::Vector3i lower, upper;

  CellBox grown(int layers) const { return {lower.array() - layers, upper.array() + layers}; }
};

inline CellBox within(const Grid& grid, CellBox box) {
  for (int axis = 0; axis < 3; ++axis) {
    const bool whole = box.upper[axis] - box.lower[axis] >= grid.cells[axis];
    if (grid.periodic[static_cast<std::size_t>(axis)] && !whole) continue;
    box.lower[axis] = std::clamp(box.lower[axis], 0, grid.cells[axis]);
    box.upper[axis] = std::clamp(box.upper[axis], box.lower[axis], grid.cells[axis]);
  }
  return box;
}

template <class Function>
void for_each_index(const Eigen::Vector3i& lower, const Eigen::Vector3i& upper, Function&& f) {
  for (int k = lower[2]; k < upper[2]; ++k) {
    for (int j = lower[1]; j < upper[1]; ++j) {
      for (int i = lower[0]; i < upper[0]; ++i) f(Eigen::Vector3i(i, j, k));
    }
  }
}
template <class Function>
void for_each_cell(const Grid& grid, const CellBox& box, Function&& f) {
  for_each_index(box.lower, box.upper, [&](const Eigen::Vector3i& i) {
    f(Eigen::Vector3i(grid.wrapped(0, i[0]), grid.wrapped(1, i[1]), grid.wrapped(2, i[2])));
  });
}
/// The faces of the box's cells along an axis.
template <class Function>
void for_each_face(const Grid& grid, int axis, const CellBox& box, Function&& f) {
  CellBox faces = box;
  ++faces.upper[axis];
  if (grid.periodic[static_cast<std::size_t>(axis)])
    faces.upper[axis] = std::min(faces.upper[axis], faces.lower[axis] + grid.cells[axis]);
  for_each_index(faces.lower, faces.upper, [&](const Eigen::Vector3i& i) {
    Eigen::Vector3i at;
    for (int a = 0; a < 3; ++a) at[a] = grid.wrapped(a, i[a]);
    f(at);
  });
}

/// Distances at a cell's corners, the first axis fastest.
inline std::array<double, 8> corner_distances(const Grid& grid, const Openings& openings,
                                              const Eigen::Vector3i& cell) {
  std::array<double, 8> corners;
  for (int corner = 0; corner < 8; ++corner)
    corners[static_cast<std::size_t>(corner)] =
        openings
            .distance[corner_index(grid, cell + Eigen::Vector3i(corner & 1, corner >> 1 & 1, corner >> 2))];
  return corners;
}

inline double interpolated(const std::array<double, 8>& corners, const Eigen::Vector3d& local) {
  std::array<double, 4> along_x;
  for (std::size_t k = 0; k < 4; ++k)
    along_x[k] = corners[2 * k] + local[0] * (corners[2 * k + 1] - corners[2 * k]);
  const double lower = along_x[0] + local[1] * (along_x[1] - along_x[0]);
  const double upper = along_x[2] + local[1] * (along_x[3] - along_x[2]);
  return lower + local[2] * (upper - lower);
}

inline Eigen::Vector3d interpolated_gradient(const std::array<double, 8>& corners,
                                             const Eigen::Vector3d& local, double spacing) {
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3i up(corner & 1, corner >> 1 & 1, corner >> 2);
    Eigen::Vector3d weight;
    for (int axis = 0; axis < 3; ++axis) weight[axis] = up[axis] ? local[axis] : 1.0 - local[axis];
    for (int axis = 0; axis < 3; ++axis) {
      gradient[axis] += (up[axis] ? 1.0 : -1.0) / spacing * weight[next_axis(axis)] *
                        weight[last_axis(axis)] * corners[static_cast<std::size_t>(corner)];
    }
  }
  return gradient;
}

inline constexpr double sample_share = 1.0 / (samples_per_axis * samples_per_axis * samples_per_axis);

template <class Function>
void for_each_sample(Function&& f) {
  for_each_index(Eigen::Vector3i::Zero(), Eigen::Vector3i::Constant(samples_per_axis),
                 [&](const Eigen::Vector3i& s) {
                   f(Eigen::Vector3d((s.cast<double>().array() + 0.5) / samples_per_axis));
                 });
}

constexpr double sample_width(const Grid& grid) { return grid.spacing / samples_per_axis; }

/// Whether all of a cell is open, by its corners.
inline bool is_clear(const Grid& grid, const std::array<double, 8>& corners) {
  return *std::min_element(corners.begin(), corners.end()) >= 0.5 * sample_width(grid);
}

/// Calls f(number of the sample, how much of its own width is open) for the samples of a cell that are open at all, by the
/// distances at its corners.
template <class Function>
void for_each_open_sample(const Grid& grid, const std::array<double, 8>& corners, Function&& f) {
  const double width = sample_width(grid);
  if (*std::max_element(corners.begin(), corners.end()) <= -0.5 * width) return;
  std::size_t sample = 0;
  for_each_sample([&](const Eigen::Vector3d& local) {
    const std::size_t number = sample++;
    const double distance = interpolated(corners, local);
    double open = distance > 0.0 ? 1.0 : 0.0;
    if (std::abs(distance) < 0.5 * width) {
      // Where walls meet the interpolant is no distance, but falls off faster than one; its slope tells how much.
      const double slope = interpolated_gradient(corners, local, grid.spacing).norm();
      open = std::clamp(0.5 + distance / (width * std::clamp(slope, smallest_opening, 1.0)), 0.0, 1.0);
    }
    if (open > 0.0) f(number, open * sample_share);
  });
}

/// The kernel shares of the cells in `boxes`, and of their faces, from what is open of cells and faces.
void measure_kernels(const Grid& grid, std::span<const CellBox> boxes, Openings& openings);

}  // namespace talus
