#include "continuum/stress/multigrid.h"

#include <cmath>

#include "continuum/parallel.h"

namespace talus {
namespace {

constexpr float link_factor = 0.6F;
constexpr int coarsest_sweeps = 4;          // of a cycle, there and back
constexpr int coarsest_nested_sweeps = 16;  // on a handful of cells
constexpr int nested_sweeps = 3;            // per finer level
/// Where more than this share of the cells changed sides, all rows are computed anew, which needs no list.
constexpr double most_changes = 0.05;

/// From the surface's side: how much further from it the middle of a parent is than that of a cell on `level`, in inverse.
float surface_factor(std::size_t level) {
  const float distance = 0.5F + std::ldexp(0.5F, static_cast<int>(level));
  return distance / (2.0F * distance - 0.5F);
}

/// The sum over a cell's neighbours of link * x.
template <class Directions>
inline float pull(Directions directions, std::ptrdiff_t n, const float* links, const int* neighbours,
                  const float* x, std::ptrdiff_t i) {
  float sum = 0.0F;
  for (int k = 0; k < directions(); ++k) sum += links[k * n + i] * x[neighbours[k * n + i]];
  return sum;
}

}  // namespace

Multigrid::Multigrid(const CellLevels& cells, const CellLaplacian& laplacian)
    : cells_(cells), laplacian_(laplacian), levels_(cells.levels.size()) {
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    const auto n = static_cast<std::size_t>(cells.levels[l].count);
    Level& level = levels_[l];
    level.links.resize(n * cells.directions.size());
    level.surface.resize(n);
    level.inverse_diagonal.resize(n);
    for (auto* field : {&level.residual, &level.value, &level.defect}) field->assign(n + 1, 0.0F);
    level.stale.assign(n, 0);
    level.stale_rows.reserve(n);
  }
  changed_.reserve(levels_[0].inverse_diagonal.size());
  const auto single = [](double x) { return static_cast<float>(x); };
  std::transform(laplacian.links.begin(), laplacian.links.end(), levels_[0].links.begin(), single);
  std::transform(laplacian.surface.begin(), laplacian.surface.end(), levels_[0].surface.begin(), single);
}

void Multigrid::mark_stale(std::size_t level, int row) {
  unsigned char& stale = levels_[level].stale[static_cast<std::size_t>(row)];
  if (!stale) levels_[level].stale_rows.push_back(row);
  stale = 1;
}

/// A row of a parent depends on its children's rows, and on which of their neighbours take part.
void Multigrid::mark_parents_stale(std::size_t level, int row) {
  const CellLevel& cells = cells_.levels[level];
  mark_stale(level + 1, cells.parent[static_cast<std::size_t>(row)]);
  for (std::size_t k = 0; k < cells_.directions.size(); ++k) {
    const int neighbour =
        cells.neighbours[k * static_cast<std::size_t>(cells.count) + static_cast<std::size_t>(row)];
    if (neighbour < cells.count) mark_stale(level + 1, cells.parent[static_cast<std::size_t>(neighbour)]);
  }
}

void Multigrid::set_free(const std::vector<unsigned char>& free) {
  const std::size_t n = free.size();
  const double* const all = laplacian_.inverse_diagonal.data();
  float* const inverse = levels_[0].inverse_diagonal.data();
  changed_.clear();
  for (std::size_t i = 0; i < n; ++i) {
    const float now = free[i] ? static_cast<float>(all[i]) : 0.0F;
    if (now != inverse[i]) changed_.push_back(static_cast<int>(i));
    inverse[i] = now;
  }
  if (levels_.size() > 1) {
    all_stale_ = !rows_known_ || static_cast<double>(changed_.size()) > most_changes * static_cast<double>(n);
    if (!all_stale_)
      for (const int row : changed_) mark_parents_stale(0, row);
    for (std::size_t l = 1; l < levels_.size(); ++l) coarsen(l);
  }
  rows_known_ = true;
}

/// Computes the rows of a level that are stale.
void Multigrid::coarsen(std::size_t level) {
  std::vector<int>& rows = levels_[level].stale_rows;
  const int n = cells_.levels[level].count;
  if (all_stale_) {
    for_each_block(n, cells_per_block / 8, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (std::ptrdiff_t row = begin; row < end; ++row) coarsen_row(level, static_cast<int>(row));
    });
    return;
  }
  for (const int row : rows) {
    coarsen_row(level, row);
    if (level + 1 < levels_.size()) mark_parents_stale(level, row);
    levels_[level].stale[static_cast<std::size_t>(row)] = 0;
  }
  rows.clear();
}

void Multigrid::coarsen_row(std::size_t level, int row) {
  const CellLevel &from = cells_.levels[level - 1], &to = cells_.levels[level];
  const Level& fine = levels_[level - 1];
  Level& coarse = levels_[level];
  const std::size_t n = static_cast<std::size_t>(from.count), m = static_cast<std::size_t>(to.count);
  const auto r = static_cast<std::size_t>(row);
  with_directions(cells_.directions.size(), [&](auto directions) {
    constexpr std::size_t count = directions();
    std::array<float, count + 1> link{};
    float surface = 0.0F;
    for (int at = to.children_begin[r]; at < to.children_begin[r + 1]; ++at) {
      const auto i = static_cast<std::size_t>(to.children[static_cast<std::size_t>(at)]);
      if (fine.inverse_diagonal[i] == 0.0F) continue;
      surface += fine.surface[i];
      for (std::size_t k = 0; k < count; ++k) {
        const auto j = static_cast<std::size_t>(from.neighbours[k * n + i]);
        if (j == n) continue;
        if (fine.inverse_diagonal[j] == 0.0F)
          surface += fine.links[k * n + i];
        else if (from.parent[j] != row)
          link[k] += fine.links[k * n + i];
      }
    }
    float diagonal = coarse.surface[r] = surface_factor(level - 1) * surface;
    for (std::size_t k = 0; k < count; ++k) {
      const auto axis = static_cast<std::size_t>(cells_.directions[k] / 2);
      const float factor = cells_.halved[level - 1][axis] ? link_factor : 1.0F;
      diagonal += coarse.links[k * m + r] = factor * link[k];
    }
    coarse.inverse_diagonal[r] = diagonal > 0.0F ? 1.0F / diagonal : 0.0F;
  });
}

void Multigrid::relax(std::size_t level, std::size_t colour) {
  const CellLevel& cells = cells_.levels[level];
  const std::ptrdiff_t n = cells.count, first = cells.colour_begin[colour],
                       last = cells.colour_begin[colour + 1];
  const float *const links = levels_[level].links.data(), *const r = levels_[level].residual.data(),
                     *const inverse = levels_[level].inverse_diagonal.data();
  const int* const neighbours = cells.neighbours.data();
  float* const x = levels_[level].value.data();
  with_directions(cells_.directions.size(), [&](auto directions) {
    for_each_block(last - first, cells_per_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
#pragma omp simd
      for (std::ptrdiff_t i = first + begin; i < first + end; ++i)
        x[i] = inverse[i] * (r[i] + pull(directions, n, links, neighbours, x, i));
    });
  });
}

void Multigrid::relax_nonnegative(std::size_t level, std::size_t colour) {
  relax(level, colour);
  const CellLevel& cells = cells_.levels[level];
  float* const x = levels_[level].value.data();
  for (int i = cells.colour_begin[colour]; i < cells.colour_begin[colour + 1]; ++i)
    x[i] = std::max(0.0F, x[i]);
}

/// A sweep over the colours in their order, from value = 0; the first colour sees nothing but the residual.
void Multigrid::relax_from_zero(std::size_t level) {
  const CellLevel& cells = cells_.levels[level];
  const float *const r = levels_[level].residual.data(), *const inverse =
                                                             levels_[level].inverse_diagonal.data();
  float* const x = levels_[level].value.data();
  if (cells.colours() > 2) std::fill_n(x, cells.count, 0.0F);
  for (int i = 0; i < cells.colour_begin[1]; ++i) x[i] = inverse[i] * r[i];
  for (std::size_t colour = 1; colour < static_cast<std::size_t>(cells.colours()); ++colour)
    relax(level, colour);
}

void Multigrid::relax_back(std::size_t level) {
  for (auto colour = static_cast<std::size_t>(cells_.levels[level].colours()); colour-- > 0;)
    relax(level, colour);
}

/// What is left after the first sweep; nothing on the last colour.
void Multigrid::find_defect(std::size_t level) {
  const CellLevel& cells = cells_.levels[level];
  const std::ptrdiff_t n = cells.count;
  const float *const links = levels_[level].links.data(), *const r = levels_[level].residual.data(),
                     *const inverse = levels_[level].inverse_diagonal.data(),
                     *const x = levels_[level].value.data();
  const int* const neighbours = cells.neighbours.data();
  float* const defect = levels_[level].defect.data();
  with_directions(cells_.directions.size(), [&](auto directions) {
    for_each_block(cells.last_colour_begin(), cells_per_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
#pragma omp simd
      for (std::ptrdiff_t i = begin; i < end; ++i) {
        const float left = r[i] + pull(directions, n, links, neighbours, x, i) - x[i] / inverse[i];
        defect[i] = inverse[i] > 0.0F ? left : 0.0F;
      }
    });
  });
}

void Multigrid::restrict_defect(std::size_t level) {
  const CellLevel& parents = cells_.levels[level + 1];
  const int last = cells_.levels[level].last_colour_begin();
  const int *const children = parents.children.data(), *const child_begin = parents.children_begin.data();
  const float* const defect = levels_[level].defect.data();
  float* const residual = levels_[level + 1].residual.data();
  for_each_block(parents.count, cells_per_block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t p = begin; p < end; ++p) {
      float sum = 0.0F;
      for (int at = child_begin[p]; at < child_begin[p + 1] && children[at] < last; ++at)
        sum += defect[children[at]];
      residual[p] = sum;
    }
  });
}

/// The last colour keeps its value: the sweep that follows begins with it.
void Multigrid::prolong(std::size_t level) {
  const int* const parent = cells_.levels[level].parent.data();
  const float *const coarse = levels_[level + 1].value.data(), *const inverse =
                                                                   levels_[level].inverse_diagonal.data();
  float* const x = levels_[level].value.data();
  for_each_block(cells_.levels[level].last_colour_begin(), cells_per_block,
                 [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
#pragma omp simd
                   for (std::ptrdiff_t i = begin; i < end; ++i)
                     x[i] += inverse[i] > 0.0F ? coarse[parent[i]] : 0.0F;
                 });
}

void Multigrid::cycle(std::size_t level) {
  relax_from_zero(level);
  if (level + 1 == levels_.size()) return solve_coarsest();
  find_defect(level);
  restrict_defect(level);
  cycle(level + 1);
  prolong(level);
  relax_back(level);
}

/// Sweeps there and back, so that the whole stays symmetric.
void Multigrid::solve_coarsest() {
  const std::size_t level = levels_.size() - 1;
  relax_back(level);
  for (int sweep = 0; sweep < coarsest_sweeps; ++sweep) {
    for (std::size_t colour = 0; colour < static_cast<std::size_t>(cells_.levels[level].colours()); ++colour)
      relax(level, colour);
    relax_back(level);
  }
}

void Multigrid::restrict_residual(std::size_t level) {
  const CellLevel& parents = cells_.levels[level + 1];
  const float *const residual = levels_[level].residual.data(), *const inverse =
                                                                    levels_[level].inverse_diagonal.data();
  for (std::size_t p = 0; p < static_cast<std::size_t>(parents.count); ++p) {
    float sum = 0.0F;
    for (int at = parents.children_begin[p]; at < parents.children_begin[p + 1]; ++at) {
      const int child = parents.children[static_cast<std::size_t>(at)];
      if (inverse[child] > 0.0F) sum += residual[child];
    }
    levels_[level + 1].residual[p] = sum;
  }
}

void Multigrid::solve_nested() {
  const std::size_t coarsest = levels_.size() - 1;
  for (std::size_t l = 0; l < coarsest; ++l) restrict_residual(l);
  std::fill(levels_[coarsest].value.begin(), levels_[coarsest].value.end(), 0.0F);
  for (std::size_t l = levels_.size(); l-- > 0;) {
    const CellLevel& cells = cells_.levels[l];
    if (l < coarsest) {
      for (std::size_t i = 0; i < cells.parent.size(); ++i)
        levels_[l].value[i] = levels_[l + 1].value[static_cast<std::size_t>(cells.parent[i])];
    }
    const int sweeps = l < coarsest ? nested_sweeps : coarsest_nested_sweeps;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      for (std::size_t c = 0; c < static_cast<std::size_t>(cells.colours()); ++c) relax_nonnegative(l, c);
    }
  }
}

}  // namespace talus
