// The shear cell's two tests as LIGGGHTS decks. Both write samples.txt, which measure.h reads.
#pragma once

#include <string>

#include "dem_cases/shear_cell/shear_cell.h"
#include "dem_cases/shear_cell/start.h"

namespace talus::dem {

/// Spheres for read_data: ids count from 1 in the order of the start; types are 1 free, 2 lower, 3 upper wall.
std::string liggghts_packing(const ShearCell& cell, const ShearStart& start);

/// Rough walls; the upper one is a piston under constant load that slides along x.
std::string simple_shear_deck(const ShearCell& cell, const ShearMaterial& material,
                              const SimpleShearPoint& point, const ShearStart& start);

/// Fully periodic; a servo in the deck's own loop holds the lateral stress.
std::string biaxial_deck(const ShearCell& cell, const ShearMaterial& material, const BiaxialPoint& point,
                         const ShearStart& start);

}  // namespace talus::dem
