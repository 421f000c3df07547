// The quadratic program of the pressure, by conjugate gradients on the free cells with multigrid as preconditioner:
//
//   minimise 1/2 x'A x + b'x   subject to  x >= 0,   A a graph Laplacian (cell_laplacian.h)
//
// A face is kept while CG runs on it: the cells with x > 0, and those at 0 which the gradient would raise. It is chosen
// anew when cells outside have more of the residual than those inside (proportioning, as MPRGP has it; it then grows by
// layers), and when a step would lead below 0. Such a step is cut at 0, all cells at once, unless that raises the energy.
// Before each new face Gauss-Seidel sweeps that keep x >= 0 take out what is local. So the energy never rises, and the
// method converges at least as projected Gauss-Seidel does. (Multigrid on what is free, sweeps on all: Graeser & Kornhuber
// 2009, "truncated nonsmooth Newton multigrid".)
//
// Starting from x = 0 it begins with nested iteration: the same problem on coarser cells first (multigrid.h).
// What was tried, and what it costs: pressure_study.md.
#pragma once

#include "continuum/qp/mprgp.h"
#include "continuum/stress/multigrid.h"

namespace talus {

/// Fields the solve works with; made once, so that solves allocate nothing.
struct NonnegativeSolve {
  explicit NonnegativeSolve(Eigen::Index cells);
  Field x, linear;  // start and solution; b (cells + 1, the last one 0)
  Field gradient, direction, product, before;
  std::vector<unsigned char> free;
  std::vector<int> front, next_front;
};

/// From `work.x` as start (all >= 0) to the minimiser. Stops when the largest component of the projected gradient is at most
/// the tolerance, in the units of b. An iteration is one step with one multigrid cycle; sweeps and the nested start, a quarter
/// to a half of its price, count as none.
BoundQpResult minimise_nonnegative(const CellLevels& cells, const CellLaplacian& laplacian,
                                   const BoundQpSettings& settings, Multigrid& multigrid,
                                   NonnegativeSolve& work);

}  // namespace talus
