// The cases that tests of the discrete codes use.
#pragma once

#include "continuum/files/atomic_file.h"
#include "tests/test_folder.h"

namespace talus::dem {

using testing::input_error;
using testing::replaced;
using testing::TestFolder;

inline const std::filesystem::path column_collapse_file =
    TALUS_SOURCE_DIR "/dem_cases/column_collapse/case.toml";
inline const std::filesystem::path tiny_column_file =
    TALUS_SOURCE_DIR "/tests/dem_cases/data/tiny_column.toml";

}  // namespace talus::dem
