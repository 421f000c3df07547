// |shear rate| of the sand in each cell: sqrt(2 e:e), e the trace-free part of the symmetric velocity gradient, so that
// simple shear dv_x/dz gives |dv_x/dz|. Shears are the means over the cell's edges that carry stress.
#pragma once

#include "continuum/stress/body_coupling.h"

namespace talus {

/// 1/s, cells + 1, from the open faces' velocities (m/s).
Field shear_rate(const ActiveRegion& region, const Field& velocity, const BodyCoupling& bodies = no_bodies(),
                 const Field& speeds = {});

}  // namespace talus
