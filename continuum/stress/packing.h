// Density correction (section 7 of method.md): where advection has packed particles above the limit, the
// packing problem is solved for a displacement of the particles, not of their velocities.
#pragma once

#include <span>

#include "continuum/particles/transfer.h"
#include "continuum/qp/mprgp.h"

namespace talus {

struct PackingResult {
  BoundQpResult solve;
  double peak_fill = 0.0;             // before the correction
  double largest_displacement = 0.0;  // m
};

/// Moves particles apart where the fill exceeds 1, by at most a quarter of a cell; the region is stale
/// afterwards when anything moved. The tolerance is in fill.
PackingResult correct_packing(const ActiveRegion& region, std::span<const Material> materials,
                              const BoundQpSettings& settings, Particles& particles);

}  // namespace talus
