#include "analysis/coarse_graining/kernel.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace talus::analysis {
namespace {

constexpr double cut_off = 4.0;  // widths of the Gaussian; what is lost there is 6e-5

/// Half the support, in cells.
double reach(const Hat& /*kernel*/, double /*spacing*/) { return 1.0; }
double reach(const Gaussian& kernel, double spacing) { return cut_off * kernel.width / spacing; }

/// Weight before normalisation; `distance` in cells.
double raw_weight(const Hat& /*kernel*/, double distance, double /*spacing*/) {
  return 1.0 - std::abs(distance);
}
double raw_weight(const Gaussian& kernel, double distance, double spacing) {
  const double s = distance * spacing / kernel.width;
  return std::exp(-0.5 * s * s);
}

int wrapped(int cell, int cells) {
  const int rest = cell % cells;
  return rest < 0 ? rest + cells : rest;
}

/// Mirrored at both faces, as often as it takes.
int folded(int cell, int cells) {
  const int place = wrapped(cell, 2 * cells);
  return place < cells ? place : 2 * cells - 1 - place;
}

}  // namespace

void check_kernel(const Kernel& kernel, const CoarseGrid& grid) {
  const auto* gaussian = std::get_if<Gaussian>(&kernel);
  if (gaussian == nullptr) return;
  const double least = 0.5 * grid.spacing.maxCoeff();
  if (gaussian->width >= least && std::isfinite(gaussian->width)) return;
  throw std::invalid_argument(fmt::format(
      "Gaussian: a width of {} m, but at least {} m (half a cell) is needed", gaussian->width, least));
}

void axis_weights(double coordinate, int axis, const CoarseGrid& grid, const Kernel& kernel,
                  std::vector<CellWeight>& weights) {
  weights.clear();
  const double spacing = grid.spacing[axis];
  const int cells = grid.cells[axis];
  const double place = (coordinate - grid.origin[axis]) / spacing - 0.5;  // in cells, from the first centre
  double sum = 0.0;
  std::visit(
      [&](const auto& shape) {
        const double half = reach(shape, spacing);
        for (int cell = static_cast<int>(std::ceil(place - half)); cell <= place + half; ++cell) {
          const double weight = raw_weight(shape, cell - place, spacing);
          sum += weight;
          weights.push_back({grid.edges[static_cast<std::size_t>(axis)] == Edge::periodic
                                 ? wrapped(cell, cells)
                                 : folded(cell, cells),
                             weight});
        }
      },
      kernel);
  for (CellWeight& entry : weights) entry.weight /= sum;
}

}  // namespace talus::analysis
