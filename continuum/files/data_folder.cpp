#include "continuum/files/data_folder.h"

namespace talus {

std::filesystem::path data_folder(std::string_view path) {
  std::error_code unreadable;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", unreadable);
  const auto installed = program.parent_path().parent_path() / "share" / "talus" / path;
  if (!unreadable && std::filesystem::is_directory(installed)) return installed;
  return std::filesystem::path(TALUS_SOURCE_FOLDER) / path;
}

}  // namespace talus
