#include "continuum/files/data_folder.h"

#include <fmt/format.h>

#include "continuum/files/input_error.h"

namespace talus {

std::filesystem::path data_folder(std::string_view path) {
  std::error_code unreadable;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", unreadable);
  auto installed = program.parent_path().parent_path() / "share" / "talus" / path;
  if (!unreadable && std::filesystem::is_directory(installed)) return installed;
  auto source = std::filesystem::path(TALUS_SOURCE_FOLDER) / path;
  if (std::filesystem::is_directory(source)) return source;
  throw InputError(fmt::format("{}: the data that comes with the programs is neither here nor in {}",
                               installed.string(), source.string()));
}

}  // namespace talus
