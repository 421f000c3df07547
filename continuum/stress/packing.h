// Density correction (section 7 of method.md): where advection has packed particles above the limit, the
// packing problem is solved for a displacement of the particles, not of their velocities.
#pragma once

#include <span>

#include "continuum/particles/transfer.h"
#include "continuum/qp/problem.h"

namespace talus {

struct PackingResult {
  BoundQpResult solve;
  double peak_fill = 0.0;  // before the correction
  // m^3, before the correction: the space that the sand takes up, m / rho_max less what lies above fill 1 in its cell.
  double bulk_volume = 0.0;
  double largest_displacement = 0.0;  // m
};

/// Moves particles apart where the fill exceeds 1, by at most a quarter of a cell; the region, and `points`, the positions
/// by cell, are stale afterwards when anything moved. The tolerance is in fill. `record`, unless empty, is given the problem.
PackingResult correct_packing(const ActiveRegion& region, const PointsByCell& points,
                              std::span<const Material> materials, const BoundQpSettings& settings,
                              Particles& particles, const ProblemRecorder& record = {});

}  // namespace talus
