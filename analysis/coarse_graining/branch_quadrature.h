// Where to look at the kernel along a branch, and with what weight: int_0^1 g(r - s b) ds = sum weight g(position).
//
// The hat is linear between planes of cell centres along each axis, so W is a cubic in s between the branch's crossings of them:
// two Gauss-Legendre points on each piece are exact. For the Gaussian, four points on each width w of the branch leave an error
// of about 1e-5 of the largest value, which is what its cut-off makes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "analysis/coarse_graining/coarse_grid.h"
#include "analysis/coarse_graining/kernel.h"

namespace talus::analysis {

struct BranchPoint {
  Eigen::Vector3d position;  // m
  double weight;             // the weights sum to 1
};

/// Points from `centre` along `centre` - `branch`. Writes over `points`.
void branch_points(const Eigen::Vector3d& centre, const Eigen::Vector3d& branch, const CoarseGrid& grid,
                   const Kernel& kernel, std::vector<BranchPoint>& points);

}  // namespace talus::analysis
