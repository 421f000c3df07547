// The case files that tests of the shear cell use.
#pragma once

#include "tests/dem_cases/case_files.h"

namespace talus::dem {

inline const std::filesystem::path shear_cell_file = TALUS_SOURCE_DIR "/dem_cases/shear_cell/case.toml";
inline const std::filesystem::path tiny_shear_cell_file =
    TALUS_SOURCE_DIR "/tests/dem_cases/data/tiny_shear_cell.toml";

}  // namespace talus::dem
