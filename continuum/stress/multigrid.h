// Multigrid for the graph Laplacian of the pressure solve, on the cells that are free to move.
//
//   value ~ A_FF^-1 residual   on the free cells F,   0 on the others:   one symmetric V-cycle, a preconditioner for CG
//
// Gauss-Seidel by colours before, and in the reverse order after, the correction from the level above: the sum of a
// parent's residuals goes up, its value comes down to all its free children. A level is the Galerkin product of the one below,
//   link_C = c sum of links between the children of two parents,   surface_C = s sum of links to what is not free,
// but for the factors. Piecewise constants are too stiff: in a uniform medium c = 1/2 has the distance between parents right, s =
// distance to the surface before over after. c = 0.6 is what converged best (pressure_study.md). A parent takes part as soon
// as one child is free: with thin layers few parents have only free children.
//
// Single precision: CG around it keeps the accuracy. Links and masses scale out, so no range is lost.
#pragma once

#include "continuum/stress/cell_laplacian.h"

namespace talus {

class Multigrid {
 public:
  /// Both arguments must outlive it.
  Multigrid(const CellLevels& cells, const CellLaplacian& laplacian);

  /// free[i] says whether cell i of level 0 takes part. Cheap where little has changed since the last call.
  void set_free(const std::vector<unsigned char>& free);
  /// One V-cycle from the residual to the value.
  void apply() { cycle(0); }
  /// value ~ argmin over value >= 0 of 1/2 value'A value - residual'value on the free cells, by nested iteration: projected
  /// Gauss-Seidel sweeps on the coarsest level, whose solution starts the next finer one.
  void solve_nested();

  std::vector<float>& residual() { return levels_[0].residual; }        // cells + 1
  const std::vector<float>& value() const { return levels_[0].value; }  // cells + 1

 private:
  struct Level {
    std::vector<float> links, surface,
        inverse_diagonal;                        // as in CellLaplacian; the inverse is 0 where not free
    std::vector<float> residual, value, defect;  // one more entry, 0
    std::vector<unsigned char> stale;            // rows to be computed anew
    std::vector<int> stale_rows;
  };
  void mark_stale(std::size_t level, int row);
  void mark_parents_stale(std::size_t level, int row);
  void coarsen(std::size_t level);
  void coarsen_row(std::size_t level, int row);
  void cycle(std::size_t level);
  void solve_coarsest();
  void relax(std::size_t level, std::size_t colour);
  void relax_nonnegative(std::size_t level, std::size_t colour);
  void relax_from_zero(std::size_t level);
  void relax_back(std::size_t level);
  void find_defect(std::size_t level);
  void restrict_defect(std::size_t level);
  void restrict_residual(std::size_t level);
  void prolong(std::size_t level);

  const CellLevels& cells_;
  const CellLaplacian& laplacian_;
  std::vector<Level> levels_;
  std::vector<int> changed_;  // cells, in the last set_free
  bool rows_known_ = false, all_stale_ = true;
};

}  // namespace talus
