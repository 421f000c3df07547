// Keeps other programs out of a folder that runs are made in, for as long as it lives.
#pragma once

#include <filesystem>

namespace talus {

enum class Sharing { alone, shared };  // shared: with others that share it

class FolderLock {
 public:
  /// Makes the folder. Throws InputError when another program has it, or it cannot be written.
  explicit FolderLock(const std::filesystem::path& folder, Sharing sharing = Sharing::alone);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace talus
