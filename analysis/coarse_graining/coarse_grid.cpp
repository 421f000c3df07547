#include "analysis/coarse_graining/coarse_grid.h"

#include <stdexcept>

namespace talus::analysis {

void check_grid(const CoarseGrid& grid) {
  if (!grid.origin.allFinite() || !grid.spacing.allFinite() || !(grid.spacing.minCoeff() > 0.0)) {
    throw std::invalid_argument("CoarseGrid: the origin must be finite and the spacing positive");
  }
  if (grid.cells.minCoeff() < 1) throw std::invalid_argument("CoarseGrid: every axis needs a cell");
}

}  // namespace talus::analysis
