// The kernel W that spreads a grain over the grid, as a product of one weight per axis: W = w_x w_y w_z / cell volume.
//
//   hat       1 - |s| / h, h the grid spacing: the continuum's own deposit
//   Gaussian  exp(-s^2 / 2 w^2), cut off at 4 w
//
// sampled at the cell centres and normalised to the sum 1, so that whatever is spread is conserved to round-off. At a wall the
// weights that would fall on cells behind it go to the cells that lie there as in a mirror: a uniform medium reads uniform up to
// the wall, where leaving the weights out, or scaling up those that are left, would not (for such strategies: Ries, Brendel &
// Wolf 2014). What varies linearly towards the wall is read in the wall's cell as it is h/24 farther in with the hat.
#pragma once

#include <variant>
#include <vector>

#include "analysis/coarse_graining/coarse_grid.h"

namespace talus::analysis {

struct Hat {};

struct Gaussian {
  double width;  // w, m; at least half the grid spacing
};

using Kernel = std::variant<Hat, Gaussian>;

struct CellWeight {
  int cell;  // along the axis
  double weight;
};

/// Weights along one axis of a point at `coordinate` (m); a cell may appear more than once. Their sum is 1.
void axis_weights(double coordinate, int axis, const CoarseGrid& grid, const Kernel& kernel,
                  std::vector<CellWeight>& weights);

/// Throws std::invalid_argument for a Gaussian that is not finite or narrower than half a cell.
void check_kernel(const Kernel& kernel, const CoarseGrid& grid);

}  // namespace talus::analysis
