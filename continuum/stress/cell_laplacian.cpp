#include "continuum/stress/cell_laplacian.h"

#include <limits>

#include "continuum/parallel.h"

namespace talus {
namespace {

/// Cells whose links are below this share of the largest count as walled in.
constexpr double smallest_diagonal = 1e-12;

/// The sum over a cell's neighbours of link * x.
template <class Directions>
inline double pull(Directions directions, std::ptrdiff_t n, const double* links, const int* neighbours,
                   const double* x, std::ptrdiff_t i) {
  double sum = 0.0;
  for (int k = 0; k < directions(); ++k) sum += links[k * n + i] * x[neighbours[k * n + i]];
  return sum;
}

struct Sums {
  double curvature = 0.0, slope = 0.0, rate = 0.0;  // rate: the largest of -d / x
  Sums& operator+=(const Sums& other) {
    curvature += other.curvature;
    slope += other.slope;
    rate = std::max(rate, other.rate);
    return *this;
  }
};

LowRank make_low_rank(const CellLevels& cells, const BodyCoupling& bodies) {
  LowRank low;
  low.modes = bodies.inverse_mass().size();
  Field sums = Field::Zero(low.modes);  // of |U| down each column
  for (const auto& [cell, row] : bodies.cells()) {
    BodyRow movable = row;
    for (int k = 0; k < row.count; ++k) {
      double& value = movable.values[static_cast<std::size_t>(k)];
      value *= std::sqrt(bodies.inverse_mass()[row.first + k]);
      sums[row.first + k] += std::abs(value);
    }
    low.cells.push_back(cells.order[static_cast<std::size_t>(cell)]);
    low.rows.push_back(movable);
  }
  low.majorant = Field::Zero(std::ssize(low.cells));
  for (std::size_t i = 0; i < low.cells.size(); ++i) {
    const BodyRow& row = low.rows[i];
    for (int k = 0; k < row.count; ++k) {
      low.majorant[static_cast<Eigen::Index>(i)] +=
          std::abs(row.values[static_cast<std::size_t>(k)]) * sums[row.first + k];
    }
  }
  return low;
}

}  // namespace

Field LowRank::transpose_times(const Field& x) const {
  Field y = Field::Zero(modes);
  for (std::size_t i = 0; i < cells.size(); ++i) rows[i].add_to(y, x[cells[i]]);
  return y;
}

void LowRank::add_times(const Field& y, Field& x) const {
  for (std::size_t i = 0; i < cells.size(); ++i) x[cells[i]] += rows[i].times(y);
}

CellLaplacian make_cell_laplacian(const ActiveRegion& region, const CellLevels& cells,
                                  const Field& inverse_mass, const BodyCoupling& bodies) {
  const std::ptrdiff_t n = region.cell_count();
  const auto directions = static_cast<Eigen::Index>(cells.directions.size());
  CellLaplacian a{Field(n * directions), Field(n), Field(n), Field(n), make_low_rank(cells, bodies)};
  const Field link_of_face = region.face_area.square() * inverse_mass;
  for_each_block(n, cells_per_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t cell = begin; cell < end; ++cell) {
      const auto& faces = region.cell_faces[static_cast<std::size_t>(cell)];
      const int place = cells.order[static_cast<std::size_t>(cell)];
      double diagonal = 0.0, surface = 0.0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        // A periodic axis one cell long: no gradient across it. Else what lies across its faces is the free surface.
        if (region.grid.cells[static_cast<int>(axis)] > 1 || region.grid.periodic[axis]) continue;
        surface += link_of_face[faces[2 * axis]] + link_of_face[faces[2 * axis + 1]];
      }
      diagonal += surface;
      for (Eigen::Index k = 0; k < directions; ++k) {
        const auto direction = static_cast<std::size_t>(cells.directions[static_cast<std::size_t>(k)]);
        const double link = link_of_face[faces[direction]];
        const bool inside = cells.levels[0].neighbours[static_cast<std::size_t>(k * n + place)] < n;
        a.links[k * n + place] = inside ? link : 0.0;
        surface += inside ? 0.0 : link;
        diagonal += link;
      }
      a.diagonal[place] = diagonal;
      a.surface[place] = surface;
    }
  });
  const double smallest = n > 0 ? smallest_diagonal * a.diagonal.maxCoeff() : 0.0;
  a.inverse_diagonal =
      (a.diagonal > smallest).select(a.diagonal.max(std::numeric_limits<double>::min()).inverse(), 0.0);
  for (std::size_t i = 0; i < a.bodies.cells.size(); ++i) {
    double& inverse = a.inverse_diagonal[a.bodies.cells[i]];
    if (inverse > 0.0) inverse = 1.0 / (1.0 / inverse + a.bodies.majorant[static_cast<Eigen::Index>(i)]);
  }
  return a;
}

void multiply(const CellLevels& cells, const CellLaplacian& laplacian, const Field& x, const Field& constant,
              Field& product) {
  const std::ptrdiff_t n = cells.levels[0].count;
  const double *const links = laplacian.links.data(), *const diagonal = laplacian.diagonal.data(),
                      *const in = x.data(), *const plus = constant.data();
  const int* const neighbours = cells.levels[0].neighbours.data();
  double* const out = product.data();
  with_directions(cells.directions.size(), [&](auto directions) {
    for_each_block(n, cells_per_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
#pragma omp simd
      for (std::ptrdiff_t i = begin; i < end; ++i)
        out[i] = plus[i] + diagonal[i] * in[i] - pull(directions, n, links, neighbours, in, i);
    });
  });
  if (laplacian.bodies.modes > 0) laplacian.bodies.add_times(laplacian.bodies.transpose_times(x), product);
}

StepMeasure multiply_and_measure(const CellLevels& cells, const CellLaplacian& laplacian,
                                 const Field& direction, const Field& x, const Field& gradient,
                                 Field& product) {
  const std::ptrdiff_t n = cells.levels[0].count;
  const double *const links = laplacian.links.data(), *const diagonal = laplacian.diagonal.data(),
                      *const d = direction.data(), *const at = x.data(), *const g = gradient.data();
  const int* const neighbours = cells.levels[0].neighbours.data();
  double* const out = product.data();
  Sums sums;
  with_directions(cells.directions.size(), [&](auto directions) {
    sums = sum_over_blocks<Sums>(n, cells_per_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      double curvature = 0.0, slope = 0.0, rate = 0.0;
#pragma omp simd reduction(+ : curvature, slope) reduction(max : rate)
      for (std::ptrdiff_t i = begin; i < end; ++i) {
        const double product_i = diagonal[i] * d[i] - pull(directions, n, links, neighbours, d, i);
        out[i] = product_i;
        curvature += d[i] * product_i;
        slope += d[i] * g[i];
        // Where x is 0 the smallest number stands for it, so that any fall is infeasible.
        const double fall = -d[i] / std::max(at[i], std::numeric_limits<double>::min());
        rate = std::max(rate, fall);
      }
      return Sums{curvature, slope, rate};
    });
  });
  if (laplacian.bodies.modes > 0) {
    const Field speeds = laplacian.bodies.transpose_times(direction);
    laplacian.bodies.add_times(speeds, product);
    sums.curvature += speeds.square().sum();
  }
  return {sums.curvature, sums.slope, 1.0 / sums.rate};
}

void relax_nonnegative(const CellLevels& cells, const CellLaplacian& laplacian, Field& linear, Field& x) {
  const LowRank& bodies = laplacian.bodies;
  std::vector<double> without_bodies;
  if (bodies.modes > 0) {
    const Field speeds = bodies.transpose_times(x);
    for (std::size_t i = 0; i < bodies.cells.size(); ++i) {
      const int cell = bodies.cells[i];
      without_bodies.push_back(linear[cell]);
      linear[cell] += bodies.rows[i].times(speeds) - bodies.majorant[static_cast<Eigen::Index>(i)] * x[cell];
    }
  }
  const CellLevel& level = cells.levels[0];
  const std::ptrdiff_t n = level.count;
  const double *const links = laplacian.links.data(), *const inverse = laplacian.inverse_diagonal.data(),
                      *const b = linear.data();
  const int* const neighbours = level.neighbours.data();
  double* const out = x.data();
  with_directions(cells.directions.size(), [&](auto directions) {
    for (int c = 0; c < level.colours(); ++c) {
      const std::ptrdiff_t first = level.colour_begin[static_cast<std::size_t>(c)],
                           last = level.colour_begin[static_cast<std::size_t>(c) + 1];
      for_each_block(last - first, cells_per_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
#pragma omp simd
        for (std::ptrdiff_t i = first + begin; i < first + end; ++i)
          out[i] = std::max(0.0, inverse[i] * (pull(directions, n, links, neighbours, out, i) - b[i]));
      });
    }
  });
  for (std::size_t i = 0; i < without_bodies.size(); ++i) linear[bodies.cells[i]] = without_bodies[i];
}

}  // namespace talus
