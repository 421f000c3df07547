// The shear cell's biaxial test as YADE input: a script, its parameters and the grains.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "dem_cases/shear_cell/shear_cell.h"
#include "dem_cases/shear_cell/start.h"

namespace talus::dem {

/// What shear_cell.py reads from parameters.json.
nlohmann::json yade_biaxial_parameters(const ShearCell& cell, const ShearMaterial& material,
                                       const BiaxialPoint& point, const ShearStart& start);

/// What it reads from packing.txt.
std::string yade_packing(const ShearStart& start);

}  // namespace talus::dem
