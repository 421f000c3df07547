#include "continuum/files/put_in_place.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace talus {

std::error_code put_in_place(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code why;
  std::filesystem::rename(from, to, why);
  if (why) return why;
  const auto folder = to.has_parent_path() ? to.parent_path() : std::filesystem::path(".");
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  // Some file systems cannot flush a folder; their names last in their own time.
  if (descriptor < 0 || (::fsync(descriptor) != 0 && errno != EINVAL)) why = {errno, std::generic_category()};
  if (descriptor >= 0) ::close(descriptor);
  return why;
}

}  // namespace talus
