#include "continuum/grid/openings.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "continuum/grid/opening_samples.h"
#include "continuum/grid/stencil.h"

namespace talus {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

/// Share of a cell within which a corner lies on a wall's surface. A wall along the grid's planes would otherwise be open or closed by
/// round-off, and where it is open the sand's contact with it stands in the closed cell behind: without friction.
constexpr double on_surface = 1e-9;

void measure_faces(const Grid& grid, const CellBox& box, Openings& openings) {
  for (int axis = 0; axis < 3; ++axis) {
    auto& shares = openings.faces[static_cast<std::size_t>(axis)];
    const Vector3i b = Vector3i::Unit(next_axis(axis)), c = Vector3i::Unit(last_axis(axis));
    for_each_face(grid, axis, box, [&](const Vector3i& i) {
      const double share = positive_share(
          {openings.distance[corner_index(grid, i)], openings.distance[corner_index(grid, i + b)],
           openings.distance[corner_index(grid, i + b + c)], openings.distance[corner_index(grid, i + c)]});
      shares[grid.face_index(axis, i)] = share < smallest_opening ? 0.0 : share;
    });
  }
}

/// Volume shares from samples of the distance.
void measure_cells(const Grid& grid, const CellBox& box, Openings& openings) {
  for_each_cell(grid, box, [&](const Vector3i& cell) {
    const auto corners = corner_distances(grid, openings, cell);
    double& share = openings.cells[grid.cell_index(cell)];
    if (is_clear(grid, corners)) {
      share = 1.0;
      return;
    }
    double faces = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side)
        faces += openings.face_share(axis, grid.face_index(axis, cell + side * Vector3i::Unit(axis)));
    }
    share = 0.0;
    // A cell whose faces are all closed is closed.
    if (faces > 0.0) for_each_open_sample(grid, corners, [&](std::size_t, double open) { share += open; });
  });
}

/// All but the distance, which is there.
void measure(const Grid& grid, std::span<const CellBox> boxes, Openings& openings) {
  for (const CellBox& box : boxes) measure_faces(grid, box, openings);
  for (const CellBox& box : boxes) measure_cells(grid, box, openings);
  measure_kernels(grid, boxes, openings);
}

double snapped(const Grid& grid, double distance) {
  return std::abs(distance) < on_surface * grid.spacing ? 0.0 : distance;
}

Vector3d corner_of(const Grid& grid, const Vector3i& i) {
  return grid.origin + grid.spacing * i.cast<double>();
}
Vector3d centre_of(const Grid& grid, const Vector3i& i) {
  return grid.origin + grid.spacing * (i.cast<double>().array() + 0.5).matrix();
}

/// All open; the arrays have their sizes, the distance has no values yet.
Openings open_space(const Grid& grid) {
  Openings openings;
  openings.distance.resize((grid.cells.array() + 1).matrix().prod());
  openings.friction = Eigen::ArrayXd::Zero(grid.cells.prod());
  openings.body = Eigen::ArrayXi::Constant(grid.cells.prod(), -1);
  openings.cells = openings.cell_kernel = Eigen::ArrayXd::Ones(grid.cells.prod());
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    openings.faces[a] = openings.face_kernel[a] =
        Eigen::ArrayXd::Ones(grid.extent(Grid::nodal_of_face(axis)).prod());
  }
  return openings;
}

/// The cells that a box in space touches, and so many layers around them.
CellBox cells_around(const Grid& grid, const Eigen::AlignedBox3d& box, int layers) {
  // Cut to the grid before they are whole numbers: a body may be further away than an int counts.
  const auto cell_at = [&](const Eigen::Vector3d& position, double beyond) -> Vector3i {
    const Eigen::Array3d cell = ((position - grid.origin) / grid.spacing).array().floor() + beyond;
    return cell.max(0.0).min(grid.cells.cast<double>().array()).cast<int>();
  };
  const Vector3i lower = cell_at(box.min(), -layers), upper = cell_at(box.max(), 1 + layers);
  return {lower, upper.cwiseMax(lower)};
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
  const auto corners = corner_distances(grid, openings, place.cell);
  return {interpolated(corners, place.local), interpolated_gradient(corners, place.local, grid.spacing)};
}

Openings make_openings(const Grid& grid, const WallDistanceFunction& walls) {
  Openings openings = open_space(grid);
  for_each_index(Vector3i::Zero(), grid.cells.array() + 1, [&](const Vector3i& i) {
    openings.distance[corner_index(grid, i)] = snapped(grid, walls(corner_of(grid, i)).distance);
  });
  const CellBox whole{Vector3i::Zero(), grid.cells};
  for_each_cell(grid, whole, [&](const Vector3i& i) {
    const WallDistance nearest = walls(centre_of(grid, i));
    openings.friction[grid.cell_index(i)] = nearest.friction;
    openings.body[grid.cell_index(i)] = nearest.body;
  });
  measure(grid, {&whole, 1}, openings);
  return openings;
}

void add_solids(const Grid& grid, const Openings& fixed, std::span<const Eigen::AlignedBox3d> places,
                const WallDistanceFunction& solids, Openings& openings) {
  if (fixed.any()) {
    openings = fixed;
  } else {
    openings = open_space(grid);
    openings.distance.setConstant(grid.spacing * grid.cells.cast<double>().norm());
  }
  std::vector<CellBox> boxes;
  for (const Eigen::AlignedBox3d& place : places) {
    const CellBox box = cells_around(grid, place, 1);
    if ((box.upper.array() <= box.lower.array()).any()) continue;
    boxes.push_back(box);
    for_each_cell(grid, box, [&](const Vector3i& i) {
      const WallDistance nearest = solids(centre_of(grid, i));
      const double to_wall = fixed.any() ? distance_at(grid, fixed, centre_of(grid, i)).distance
                                         : std::numeric_limits<double>::infinity();
      if (nearest.distance >= to_wall) return;
      openings.friction[grid.cell_index(i)] = nearest.friction;
      openings.body[grid.cell_index(i)] = nearest.body;
    });
    for_each_index(box.lower, box.upper.array() + 1, [&](const Vector3i& i) {
      double& distance = openings.distance[corner_index(grid, i)];
      distance = std::min(distance, snapped(grid, solids(corner_of(grid, i)).distance));
    });
  }
  measure(grid, boxes, openings);
}

}  // namespace talus
