// Which share of the deposition kernels of cells and faces lies where sand may be.
#include <vector>

#include "continuum/grid/active_region.h"
#include "continuum/grid/opening_samples.h"
#include "continuum/grid/stencil.h"

namespace talus {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

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

LocalWeights weights_of_cut_cell(const std::vector<SampleKernel>& samples, const Grid& grid,
                                 const std::array<double, 8>& corners) {
  LocalWeights sum;
  for_each_open_sample(grid, corners,
                       [&](std::size_t number, double share) { add_sample(samples[number], share, sum); });
  return sum;
}

/// The cells and faces that LocalWeights are for, by their dense indices.
struct Reach {
  std::array<int, 27> cells;
  std::array<std::array<int, 18>, 3> faces;
};
constexpr std::size_t own_cell = local_neighbour(0, 0, 0);
constexpr std::array<std::size_t, 2> own_faces{4, 13};

Reach reach_of(const Grid& grid, const Vector3i& at) {
  Reach reach;
  for_each_index(Vector3i::Constant(-1), Vector3i::Constant(2), [&](const Vector3i& offset) {
    Vector3i place;
    for (int axis = 0; axis < 3; ++axis) place[axis] = kept_inside(grid, axis, at[axis], offset[axis]);
    reach.cells[static_cast<std::size_t>(local_neighbour(offset[0], offset[1], offset[2]))] =
        grid.cell_index(place);
  });
  for (int axis = 0; axis < 3; ++axis) {
    const int b = next_axis(axis), c = last_axis(axis);
    for (int entry = 0; entry < 18; ++entry) {
      Vector3i place = at + entry / 9 * Vector3i::Unit(axis);
      place[b] = kept_inside(grid, b, at[b], entry % 3 - 1);
      place[c] = kept_inside(grid, c, at[c], entry % 9 / 3 - 1);
      reach.faces[static_cast<std::size_t>(axis)][static_cast<std::size_t>(entry)] =
          grid.face_index(axis, place);
    }
  }
  return reach;
}

/// reach_of, for cells off the grid's ends from that of one of them.
class ReachOfCells {
 public:
  explicit ReachOfCells(const Grid& grid) : grid_(grid) {
    if ((grid.cells.array() >= 3).all()) inner_ = reach_of(grid, Vector3i::Ones());
  }

  Reach operator()(const Vector3i& at) const {
    if ((at.array() < 1).any() || (at.array() > grid_.cells.array() - 2).any()) return reach_of(grid_, at);
    Reach reach = inner_;
    const int cells = grid_.cell_index(at) - inner_.cells[own_cell];
    for (int& cell : reach.cells) cell += cells;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int faces = grid_.face_index(static_cast<int>(axis), at) - inner_.faces[axis][own_faces[0]];
      for (int& face : reach.faces[axis]) face += faces;
    }
    return reach;
  }

 private:
  const Grid& grid_;
  Reach inner_{};
};

/// Adds weights to the kernels that they are of, redirected as grid/stencil.h says.
void add_weights(const Openings& openings, const LocalWeights& weights, const Reach& reach,
                 KernelShares& kernels) {
  const auto own = reach.cells[own_cell];
  for (std::size_t entry = 0; entry < reach.cells.size(); ++entry) {
    const double weight = weights.cells[entry];
    if (weight == 0.0) continue;
    const int cell = reach.cells[entry];
    if (openings.cells[cell] > 0.0)
      kernels.cells[cell] += weight;
    else if (openings.cells[own] > 0.0)
      kernels.cells[own] += weight;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto& faces = reach.faces[axis];
    const auto is_open = [&](int face) { return openings.faces[axis][face] > 0.0; };
    for (std::size_t entry = 0; entry < faces.size(); ++entry) {
      const double weight = weights.faces[axis][entry];
      if (weight == 0.0) continue;
      const std::size_t side = entry / 9;
      int face = faces[entry];
      if (!is_open(face)) face = faces[own_faces[side]];
      if (!is_open(face)) face = faces[own_faces[1 - side]];
      if (is_open(face)) kernels.faces[axis][face] += weight;
    }
  }
}

}  // namespace

void measure_kernels(const Grid& grid, std::span<const CellBox> boxes, Openings& openings) {
  static const std::vector<SampleKernel> samples = make_sample_kernels();
  static const LocalWeights of_clear_cell = weights_of_clear_cell(samples);  // most around a solid are
  const ReachOfCells reach(grid);
  KernelShares kernels{Eigen::ArrayXd::Zero(openings.cells.size()), {}, {}};
  kernels.sampled.assign(static_cast<std::size_t>(openings.cells.size()), 0);
  for (std::size_t axis = 0; axis < 3; ++axis)
    kernels.faces[axis] = Eigen::ArrayXd::Zero(openings.faces[axis].size());
  for (const CellBox& box : boxes) {
    for_each_cell(grid, within(grid, box.grown(2)), [&](const Vector3i& cell) {
      char& sampled = kernels.sampled[static_cast<std::size_t>(grid.cell_index(cell))];
      if (sampled) return;
      sampled = 1;
      const auto corners = corner_distances(grid, openings, cell);
      if (is_clear(grid, corners))
        add_weights(openings, of_clear_cell, reach(cell), kernels);
      else
        add_weights(openings, weights_of_cut_cell(samples, grid, corners), reach(cell), kernels);
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

}  // namespace talus
