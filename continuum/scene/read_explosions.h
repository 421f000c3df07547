// The tables [[explosion]] of a scene.
#pragma once

#include <vector>

#include "continuum/files/checked_table.h"
#include "continuum/solids/explosion.h"

namespace talus {

/// Keys: time_s (after the start), centre_m, radius_m, speed_m_s. Throws InputError.
std::vector<Explosion> read_explosions(const CheckedTable& root);

}  // namespace talus
