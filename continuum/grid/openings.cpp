#include "continuum/grid/openings.h"

#include <algorithm>

#include "continuum/grid/stencil.h"

namespace talus {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr int samples_per_axis = 4;  // per cell, for volume shares

/// Share of a cell within which a corner lies on a wall's surface. A wall along the grid's planes would otherwise be open or closed by
/// round-off, and where it is open the sand's contact with it stands in the closed cell behind: without friction.
constexpr double on_surface = 1e-9;

/// Corners are counted at both ends of every axis, periodic or not.
int corner_index(const Grid& grid, const Vector3i& i) {
  return i[0] + (grid.cells[0] + 1) * (i[1] + (grid.cells[1] + 1) * i[2]);
}

template <class Function>
void for_each_index(const Vector3i& extent, Function&& f) {
  for (int k = 0; k < extent[2]; ++k) {
    for (int j = 0; j < extent[1]; ++j) {
      for (int i = 0; i < extent[0]; ++i) f(Vector3i(i, j, k));
    }
  }
}

void measure_faces(const Grid& grid, Openings& openings) {
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3i extent = grid.extent(Grid::nodal_of_face(axis));
    auto& shares = openings.faces[static_cast<std::size_t>(axis)];
    shares.resize(extent.prod());
    const Vector3i b = Vector3i::Unit(next_axis(axis)), c = Vector3i::Unit(last_axis(axis));
    for_each_index(extent, [&](const Vector3i& i) {
      const double share = positive_share(
          {openings.distance[corner_index(grid, i)], openings.distance[corner_index(grid, i + b)],
           openings.distance[corner_index(grid, i + b + c)], openings.distance[corner_index(grid, i + c)]});
      shares[grid.face_index(axis, i)] = share < smallest_opening ? 0.0 : share;
    });
  }
}

/// Volume shares from samples of the distance, each counted by how much of its own width is open.
void measure_volumes(const Grid& grid, Openings& openings) {
  const double sample_width = grid.spacing / samples_per_axis;
  const double sample_share = 1.0 / (samples_per_axis * samples_per_axis * samples_per_axis);
  openings.cells = openings.cell_kernel = Eigen::ArrayXd::Zero(grid.cells.prod());
  const auto sample = [&](auto&& f) {
    for_each_index(grid.cells, [&](const Vector3i& cell) {
      for_each_index(Vector3i::Constant(samples_per_axis), [&](const Vector3i& s) {
        const Vector3d local = (s.cast<double>().array() + 0.5) / samples_per_axis;
        const Vector3d position = grid.origin + grid.spacing * (cell.cast<double>() + local);
        // Where walls meet the interpolant is no distance, but falls off faster than one; its slope tells how much.
        const auto [distance, gradient] = distance_at(grid, openings, position);
        const double open = std::clamp(
            0.5 + distance / (sample_width * std::clamp(gradient.norm(), smallest_opening, 1.0)), 0.0, 1.0);
        if (open > 0.0) f(Place{cell, local}, open * sample_share);
      });
    });
  };
  sample([&](const Place& place, double share) { openings.cells[grid.cell_index(place.cell)] += share; });
  // A cell whose faces are all closed is closed.
  for_each_index(grid.cells, [&](const Vector3i& cell) {
    double faces = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side)
        faces += openings.face_share(axis, grid.face_index(axis, cell + side * Vector3i::Unit(axis)));
    }
    if (faces == 0.0) openings.cells[grid.cell_index(cell)] = 0.0;
  });
  for (std::size_t axis = 0; axis < 3; ++axis)
    openings.face_kernel[axis] = Eigen::ArrayXd::Zero(openings.faces[axis].size());
  sample([&](const Place& place, double share) {
    const auto cell = [&](int dense) { return openings.cells[dense] > 0.0 ? dense : is_closed; };
    const Stencil cells = cell_stencil(grid, place, cell, -1);
    for (std::size_t k = 0; k < 8; ++k) {
      if (cells.index[k] >= 0) openings.cell_kernel[cells.index[k]] += cells.weight[k] * share;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto face = [&](int dense) { return openings.face_share(axis, dense) > 0.0 ? dense : is_closed; };
      const Stencil faces = face_stencil(grid, place, axis, face);
      auto& kernel = openings.face_kernel[static_cast<std::size_t>(axis)];
      for (std::size_t k = 0; k < 8; ++k) {
        if (faces.index[k] >= 0) kernel[faces.index[k]] += faces.weight[k] * share;
      }
    }
  });
}

}  // namespace

double positive_share(const std::array<double, 4>& corners) {
  constexpr std::array<std::array<double, 2>, 4> square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  // Shoelace over the clipped polygon.
  std::array<std::array<double, 2>, 8> polygon{};
  std::size_t n = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    if (corners[k] > 0.0) polygon[n++] = square[k];
    if ((corners[k] > 0.0) != (corners[next] > 0.0)) {
      const double t = corners[k] / (corners[k] - corners[next]);
      polygon[n++] = {square[k][0] + t * (square[next][0] - square[k][0]),
                      square[k][1] + t * (square[next][1] - square[k][1])};
    }
  }
  double area = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const auto &p = polygon[k], &q = polygon[(k + 1) % n];
    area += 0.5 * (p[0] * q[1] - q[0] * p[1]);
  }
  return std::clamp(area, 0.0, 1.0);
}

DistanceAndGradient distance_at(const Grid& grid, const Openings& openings, const Vector3d& position) {
  const Place place = place_of(grid, position);
  DistanceAndGradient found{0.0, Vector3d::Zero()};
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3i up(corner & 1, corner >> 1 & 1, corner >> 2);
    const Vector3d weight =
        up.cast<double>().cwiseProduct(place.local) +
        (1.0 - up.cast<double>().array()).matrix().cwiseProduct((1.0 - place.local.array()).matrix());
    const double value = openings.distance[corner_index(grid, place.cell + up)];
    found.distance += weight.prod() * value;
    for (int axis = 0; axis < 3; ++axis) {
      found.gradient[axis] +=
          (up[axis] ? 1.0 : -1.0) / grid.spacing * weight[next_axis(axis)] * weight[last_axis(axis)] * value;
    }
  }
  return found;
}

Openings make_openings(const Grid& grid, const WallDistanceFunction& walls) {
  Openings openings;
  const Vector3i corners = grid.cells.array() + 1;
  openings.distance.resize(corners.prod());
  for_each_index(corners, [&](const Vector3i& i) {
    const double distance = walls(grid.origin + grid.spacing * i.cast<double>()).distance;
    openings.distance[corner_index(grid, i)] =
        std::abs(distance) < on_surface * grid.spacing ? 0.0 : distance;
  });
  openings.friction.resize(grid.cells.prod());
  for_each_index(grid.cells, [&](const Vector3i& i) {
    openings.friction[grid.cell_index(i)] =
        walls(grid.origin + grid.spacing * (i.cast<double>().array() + 0.5).matrix()).friction;
  });
  measure_faces(grid, openings);
  measure_volumes(grid, openings);
  return openings;
}

}  // namespace talus
