#include "continuum/files/folder_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"

namespace talus {

FolderLock::FolderLock(const std::filesystem::path& folder, Sharing sharing) {
  make_writable_folder(folder);
  descriptor_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const int how = sharing == Sharing::alone ? LOCK_EX : LOCK_SH;
  if (descriptor_ < 0 || ::flock(descriptor_, how | LOCK_NB) != 0) {
    const int why = errno;
    if (descriptor_ >= 0) ::close(descriptor_);
    if (why != EWOULDBLOCK)
      throw InputError(fmt::format("{}: cannot be locked: {}", folder.string(), std::strerror(why)));
    throw InputError(fmt::format(
        "{}: another program is making runs there; wait for it, or give another folder", folder.string()));
  }
}

FolderLock::~FolderLock() { ::close(descriptor_); }

}  // namespace talus
