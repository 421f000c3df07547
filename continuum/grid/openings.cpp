#include "continuum/grid/openings.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "continuum/grid/active_region.h"
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

/// Cells from `lower` up to and without `upper`; of the rows that stick out of the domain, those along periodic axes stand for
/// the rows at the other end.
struct CellBox {
  Vector3i lower, upper;

  CellBox grown(int layers) const { return {lower.array() - layers, upper.array() + layers}; }
};

CellBox within(const Grid& grid, CellBox box) {
  for (int axis = 0; axis < 3; ++axis) {
    const bool whole = box.upper[axis] - box.lower[axis] >= grid.cells[axis];
    if (grid.periodic[static_cast<std::size_t>(axis)] && !whole) continue;
    box.lower[axis] = std::clamp(box.lower[axis], 0, grid.cells[axis]);
    box.upper[axis] = std::clamp(box.upper[axis], box.lower[axis], grid.cells[axis]);
  }
  return box;
}

template <class Function>
void for_each_index(const Vector3i& lower, const Vector3i& upper, Function&& f) {
  for (int k = lower[2]; k < upper[2]; ++k) {
    for (int j = lower[1]; j < upper[1]; ++j) {
      for (int i = lower[0]; i < upper[0]; ++i) f(Vector3i(i, j, k));
    }
  }
}
template <class Function>
void for_each_cell(const Grid& grid, const CellBox& box, Function&& f) {
  for_each_index(box.lower, box.upper, [&](const Vector3i& i) {
    f(Vector3i(grid.wrapped(0, i[0]), grid.wrapped(1, i[1]), grid.wrapped(2, i[2])));
  });
}
/// The faces of the box's cells along an axis.
template <class Function>
void for_each_face(const Grid& grid, int axis, const CellBox& box, Function&& f) {
  CellBox faces = box;
  ++faces.upper[axis];
  if (grid.periodic[static_cast<std::size_t>(axis)])
    faces.upper[axis] = std::min(faces.upper[axis], faces.lower[axis] + grid.cells[axis]);
  for_each_index(faces.lower, faces.upper, [&](const Vector3i& i) {
    Vector3i at;
    for (int a = 0; a < 3; ++a) at[a] = grid.wrapped(a, i[a]);
    f(at);
  });
}

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

/// Distances at a cell's corners, the first axis fastest.
std::array<double, 8> corner_distances(const Grid& grid, const Openings& openings, const Vector3i& cell) {
  std::array<double, 8> corners;
  for (int corner = 0; corner < 8; ++corner)
    corners[static_cast<std::size_t>(corner)] =
        openings.distance[corner_index(grid, cell + Vector3i(corner & 1, corner >> 1 & 1, corner >> 2))];
  return corners;
}

double interpolated(const std::array<double, 8>& corners, const Vector3d& local) {
  std::array<double, 4> along_x;
  for (std::size_t k = 0; k < 4; ++k)
    along_x[k] = corners[2 * k] + local[0] * (corners[2 * k + 1] - corners[2 * k]);
  const double lower = along_x[0] + local[1] * (along_x[1] - along_x[0]);
  const double upper = along_x[2] + local[1] * (along_x[3] - along_x[2]);
  return lower + local[2] * (upper - lower);
}

Vector3d interpolated_gradient(const std::array<double, 8>& corners, const Vector3d& local, double spacing) {
  Vector3d gradient = Vector3d::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3i up(corner & 1, corner >> 1 & 1, corner >> 2);
    Vector3d weight;
    for (int axis = 0; axis < 3; ++axis) weight[axis] = up[axis] ? local[axis] : 1.0 - local[axis];
    for (int axis = 0; axis < 3; ++axis) {
      gradient[axis] += (up[axis] ? 1.0 : -1.0) / spacing * weight[next_axis(axis)] *
                        weight[last_axis(axis)] * corners[static_cast<std::size_t>(corner)];
    }
  }
  return gradient;
}

constexpr double sample_share = 1.0 / (samples_per_axis * samples_per_axis * samples_per_axis);

template <class Function>
void for_each_sample(Function&& f) {
  for_each_index(Vector3i::Zero(), Vector3i::Constant(samples_per_axis), [&](const Vector3i& s) {
    f(Vector3d((s.cast<double>().array() + 0.5) / samples_per_axis));
  });
}

constexpr double sample_width(const Grid& grid) { return grid.spacing / samples_per_axis; }

/// Whether all of a cell is open, by its corners.
bool is_clear(const Grid& grid, const std::array<double, 8>& corners) {
  return *std::min_element(corners.begin(), corners.end()) >= 0.5 * sample_width(grid);
}

/// Calls f(number of the sample, how much of its own width is open) for the samples of a cell that are open at all.
template <class Function>
void for_each_open_sample(const Grid& grid, const Openings& openings, const Vector3i& cell, Function&& f) {
  const double width = sample_width(grid);
  const auto corners = corner_distances(grid, openings, cell);
  if (*std::max_element(corners.begin(), corners.end()) <= -0.5 * width) return;
  const bool clear = is_clear(grid, corners);
  std::size_t sample = 0;
  for_each_sample([&](const Vector3d& local) {
    const std::size_t number = sample++;
    if (clear) return f(number, sample_share);
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

/// Volume shares from samples of the distance.
void measure_cells(const Grid& grid, const CellBox& box, Openings& openings) {
  for_each_cell(grid, box, [&](const Vector3i& cell) {
    double faces = 0.0, share = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side)
        faces += openings.face_share(axis, grid.face_index(axis, cell + side * Vector3i::Unit(axis)));
    }
    // A cell whose faces are all closed is closed.
    if (faces > 0.0)
      for_each_open_sample(grid, openings, cell, [&](std::size_t, double open) { share += open; });
    openings.cells[grid.cell_index(cell)] = share;
  });
}

/// Kernel shares of the cells of a box and of their faces, from the samples of all cells whose kernels reach them.
struct KernelShares {
  Eigen::ArrayXd cells;
  std::array<Eigen::ArrayXd, 3> faces;
  std::vector<char> sampled;  // cells
};

/// Weights on the cells around a cell (by local_neighbour), and on their faces (as CellStencil::faces has them).
struct LocalWeights {
  std::array<double, 27> cells{};
  std::array<std::array<double, 18>, 3> faces{};
};

/// Where the kernel of each sample puts its weight: entries of LocalWeights, eight of the cells and eight of each axis' faces.
struct SampleKernel {
  std::array<int, 8> cells;
  std::array<double, 8> cell_weights;
  std::array<std::array<int, 8>, 3> faces;
  std::array<std::array<double, 8>, 3> face_weights;
};

std::vector<SampleKernel> make_sample_kernels() {
  const Grid grid{Vector3d::Zero(), 1.0, Vector3i::Constant(5), {false, false, false}};
  const Vector3i middle = Vector3i::Constant(2);
  const auto same = [](int dense) { return dense; };
  std::vector<SampleKernel> kernels;
  for_each_sample([&](const Vector3d& local) {
    SampleKernel kernel;
    const Stencil cells = cell_stencil(grid, {middle, local}, same, -1);
    kernel.cell_weights = cells.weight;
    for (std::size_t k = 0; k < 8; ++k) {
      const Vector3i offset = grid.cell_of_index(cells.index[k]) - middle;
      kernel.cells[k] = local_neighbour(offset[0], offset[1], offset[2]);
    }
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const Vector3i extent = grid.extent(Grid::nodal_of_face(axis));
      const Stencil faces = face_stencil(grid, {middle, local}, axis, same);
      kernel.face_weights[a] = faces.weight;
      for (std::size_t k = 0; k < 8; ++k) {
        const int dense = faces.index[k];
        const Vector3i offset =
            Vector3i(dense % extent[0], dense / extent[0] % extent[1], dense / (extent[0] * extent[1])) -
            middle;
        kernel.faces[a][k] =
            9 * offset[axis] + 3 * (1 + offset[last_axis(axis)]) + 1 + offset[next_axis(axis)];
      }
    }
    kernels.push_back(kernel);
  });
  return kernels;
}

void add_sample(const SampleKernel& sample, double share, LocalWeights& sum) {
  for (std::size_t k = 0; k < 8; ++k)
    sum.cells[static_cast<std::size_t>(sample.cells[k])] += share * sample.cell_weights[k];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t k = 0; k < 8; ++k)
      sum.faces[axis][static_cast<std::size_t>(sample.faces[axis][k])] +=
          share * sample.face_weights[axis][k];
  }
}

LocalWeights weights_of_clear_cell(const std::vector<SampleKernel>& samples) {
  LocalWeights sum;
  for (const SampleKernel& sample : samples) add_sample(sample, sample_share, sum);
  return sum;
}

LocalWeights sampled_weights(const Grid& grid, const Openings& openings, const Vector3i& at) {
  static const std::vector<SampleKernel> samples = make_sample_kernels();
  static const LocalWeights clear = weights_of_clear_cell(samples);  // most cells around a solid are
  if (is_clear(grid, corner_distances(grid, openings, at))) return clear;
  LocalWeights sum;
  for_each_open_sample(grid, openings, at,
                       [&](std::size_t number, double share) { add_sample(samples[number], share, sum); });
  return sum;
}

/// Adds what the samples of a cell give to the kernels around it, redirected as grid/stencil.h says.
void sample_kernels(const Grid& grid, const Openings& openings, const Vector3i& at, KernelShares& kernels) {
  const LocalWeights weights = sampled_weights(grid, openings, at);
  const int own = grid.cell_index(at);
  for_each_index(Vector3i::Constant(-1), Vector3i::Constant(2), [&](const Vector3i& offset) {
    const double weight =
        weights.cells[static_cast<std::size_t>(local_neighbour(offset[0], offset[1], offset[2]))];
    if (weight == 0.0) return;
    Vector3i place;
    for (int axis = 0; axis < 3; ++axis) place[axis] = kept_inside(grid, axis, at[axis], offset[axis]);
    const int dense = grid.cell_index(place);
    if (openings.cells[dense] > 0.0)
      kernels.cells[dense] += weight;
    else if (openings.cells[own] > 0.0)
      kernels.cells[own] += weight;
  });
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const int b = next_axis(axis), c = last_axis(axis);
    const auto open_face = [&](const Vector3i& place) {
      const int dense = grid.face_index(axis, place);
      return openings.face_share(axis, dense) > 0.0 ? dense : -1;
    };
    const std::array<int, 2> own_faces{open_face(at), open_face(at + Vector3i::Unit(axis))};
    for (int entry = 0; entry < 18; ++entry) {
      const double weight = weights.faces[a][static_cast<std::size_t>(entry)];
      if (weight == 0.0) continue;
      const int side = entry / 9;
      Vector3i place = at + side * Vector3i::Unit(axis);
      place[b] = kept_inside(grid, b, at[b], entry % 3 - 1);
      place[c] = kept_inside(grid, c, at[c], entry % 9 / 3 - 1);
      int dense = open_face(place);
      if (dense < 0) dense = own_faces[static_cast<std::size_t>(side)];
      if (dense < 0) dense = own_faces[static_cast<std::size_t>(1 - side)];
      if (dense >= 0) kernels.faces[a][dense] += weight;
    }
  }
}

void measure_kernels(const Grid& grid, std::span<const CellBox> boxes, Openings& openings) {
  KernelShares kernels{Eigen::ArrayXd::Zero(openings.cells.size()), {}, {}};
  kernels.sampled.assign(static_cast<std::size_t>(openings.cells.size()), 0);
  for (std::size_t axis = 0; axis < 3; ++axis)
    kernels.faces[axis] = Eigen::ArrayXd::Zero(openings.faces[axis].size());
  for (const CellBox& box : boxes) {
    for_each_cell(grid, within(grid, box.grown(2)), [&](const Vector3i& cell) {
      char& sampled = kernels.sampled[static_cast<std::size_t>(grid.cell_index(cell))];
      if (!sampled) sample_kernels(grid, openings, cell, kernels);
      sampled = 1;
    });
  }
  for (const CellBox& box : boxes) {
    const CellBox reached = within(grid, box.grown(1));
    for_each_cell(grid, reached, [&](const Vector3i& cell) {
      openings.cell_kernel[grid.cell_index(cell)] = kernels.cells[grid.cell_index(cell)];
    });
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      // The outer faces of the outermost cells are also reached by cells that were not sampled.
      CellBox inner = reached;
      if (!grid.periodic[a]) {
        inner.lower[axis] += inner.lower[axis] > 0;
        inner.upper[axis] -= inner.upper[axis] < grid.cells[axis];
      }
      for_each_face(grid, axis, inner, [&](const Vector3i& at) {
        const int face = grid.face_index(axis, at);
        openings.face_kernel[a][face] = kernels.faces[a][face];
      });
    }
  }
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
