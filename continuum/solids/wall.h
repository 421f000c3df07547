// Fixed solids, and gates: solids that are there until they open.
#pragma once

#include <limits>
#include <span>

#include "continuum/grid/openings.h"
#include "continuum/solids/shape.h"

namespace talus {

inline constexpr double as_rough_as_sand = -1.0;

struct Wall {
  Shape shape;
  double friction;                                            // mu_w, or as_rough_as_sand
  double opens_at = std::numeric_limits<double>::infinity();  // s

  bool stands_at(double time) const { return time < opens_at; }
};

/// The nearest wall that stands at `time`.
WallDistance nearest_wall(std::span<const Wall> walls, double time, const Eigen::Vector3d& position);

/// What the walls that stand at `time` leave open of the grid; nothing is closed when none stands.
Openings openings_of(const Grid& grid, std::span<const Wall> walls, double time);

/// When the next gate opens after `time`, s; infinite when none does.
double next_opening(std::span<const Wall> walls, double time);

}  // namespace talus
