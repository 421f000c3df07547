// Where the files lie that come with the programs: cases, suites, the reference ensemble, scripts.
#pragma once

#include <filesystem>
#include <string_view>

namespace talus {

/// A folder of the source tree by its path in it, such as "validation/suites": under share/talus beside the program's own folder
/// where it is installed, else in the source tree that the program was built from. Throws
/// InputError when it is in neither.
std::filesystem::path data_folder(std::string_view path);

}  // namespace talus
