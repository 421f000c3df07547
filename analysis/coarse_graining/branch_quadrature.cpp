#include "analysis/coarse_graining/branch_quadrature.h"

#include <gsl/gsl_integration.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <new>

namespace talus::analysis {
namespace {

/// Places and weights on [0, 1].
struct Rule {
  std::vector<double> place, weight;
};

Rule gauss_legendre(std::size_t points) {
  const std::unique_ptr<gsl_integration_glfixed_table, decltype(&gsl_integration_glfixed_table_free)> table(
      gsl_integration_glfixed_table_alloc(points), &gsl_integration_glfixed_table_free);
  if (!table) throw std::bad_alloc();
  Rule rule{std::vector<double>(points), std::vector<double>(points)};
  for (std::size_t k = 0; k < points; ++k) {
    gsl_integration_glfixed_point(0.0, 1.0, k, &rule.place[k], &rule.weight[k], table.get());
  }
  return rule;
}

const Rule& rule_for(const Hat& /*kernel*/) {
  static const Rule rule = gauss_legendre(2);
  return rule;
}
const Rule& rule_for(const Gaussian& /*kernel*/) {
  static const Rule rule = gauss_legendre(4);
  return rule;
}

/// Where the branch is cut, in s from 0 to 1: at the planes of cell centres.
std::vector<double> cuts(const Hat& /*kernel*/, const Eigen::Vector3d& centre, const Eigen::Vector3d& branch,
                         const CoarseGrid& grid) {
  std::vector<double> at{0.0, 1.0};
  for (int axis = 0; axis < 3; ++axis) {
    const double from = (centre[axis] - grid.origin[axis]) / grid.spacing[axis] - 0.5;  // in cells
    const double to = from - branch[axis] / grid.spacing[axis];
    for (double plane = std::ceil(std::min(from, to)); plane <= std::max(from, to) && from != to;
         plane += 1.0) {
      at.push_back((from - plane) / (from - to));
    }
  }
  std::ranges::sort(at);
  return at;
}

std::vector<double> cuts(const Gaussian& kernel, const Eigen::Vector3d& /*centre*/,
                         const Eigen::Vector3d& branch, const CoarseGrid& /*grid*/) {
  const int pieces = std::max(1, static_cast<int>(std::ceil(branch.norm() / kernel.width)));
  std::vector<double> at;
  for (int piece = 0; piece <= pieces; ++piece) at.push_back(static_cast<double>(piece) / pieces);
  return at;
}

}  // namespace

void branch_points(const Eigen::Vector3d& centre, const Eigen::Vector3d& branch, const CoarseGrid& grid,
                   const Kernel& kernel, std::vector<BranchPoint>& points) {
  points.clear();
  std::visit(
      [&](const auto& shape) {
        const Rule& rule = rule_for(shape);
        const std::vector<double> at = cuts(shape, centre, branch, grid);
        for (std::size_t piece = 0; piece + 1 < at.size(); ++piece) {
          const double length = at[piece + 1] - at[piece];
          for (std::size_t k = 0; k < rule.place.size(); ++k) {
            points.push_back(
                {centre - (at[piece] + rule.place[k] * length) * branch, rule.weight[k] * length});
          }
        }
      },
      kernel);
}

}  // namespace talus::analysis
