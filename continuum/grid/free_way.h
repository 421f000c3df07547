// Whether sand could have come from one place to another without passing through a solid.
#pragma once

#include "continuum/grid/openings.h"

namespace talus {

/// Whether `to` is outside solids, and nothing of one, however thin, is on the straight way to it; `from` itself may be on one. Both lie in the
/// domain, but for its periodic axes.
bool is_free_way(const Grid& grid, const Openings& openings, const Eigen::Vector3d& from,
                 const Eigen::Vector3d& to);

}  // namespace talus
