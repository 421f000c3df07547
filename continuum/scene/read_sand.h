// The tables of a scene that say what sand there is: [[material]], [[sand]] and [[source]].
#pragma once

#include "continuum/files/checked_table.h"
#include "continuum/files/faults.h"
#include "continuum/scene/scene.h"

namespace talus {

/// At least one. Throws InputError.
void read_materials(const CheckedTable& root, Scene& scene);

// Both read all tables that can be read into `scene`, and return whether these are all; there may be none. `scene` has its grid and
// materials by then.

bool read_fillings(const CheckedTable& root, Faults& faults, Scene& scene);
/// `scene` also has its walls, and its particles per cell, which space what enters.
bool read_sources(const CheckedTable& root, Faults& faults, Scene& scene);

}  // namespace talus
