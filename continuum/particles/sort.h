// Particles in the order of the cells they lie in.
#pragma once

#include "continuum/grid/points_by_cell.h"
#include "continuum/particles/particles.h"

namespace talus {

/// Reorders particles by cell, stably; `points`, their positions sorted, then finds them in place. Every particle must lie
/// in the domain: std::invalid_argument otherwise.
void sort_by_cell(PointsByCell& points, Particles& particles);

}  // namespace talus
