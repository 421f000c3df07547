// The [geometry] table of a case file.
#pragma once

#include <string_view>

#include "continuum/files/checked_table.h"
#include "dem_cases/case.h"

namespace talus::dem {

/// Reads and checks the geometry of a case of `kind`; lengths must be possible for its grains. Throws InputError.
Geometry read_geometry(const CheckedTable& table, std::string_view kind, const Grains& grains);

}  // namespace talus::dem
