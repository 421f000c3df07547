// What every fuzz target does: the bytes become a file, and reading it may end in the errors that users are told of, never in others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "continuum/files/process.h"

namespace talus::testing {

/// A folder of this process's own, with what the files that are tried may name; gone at the end, but not after a crash.
inline const std::filesystem::path& fuzz_folder() {
  static const ScratchFolder folder;
  return folder.path();
}

/// The bytes as a file of this name in the folder.
inline std::filesystem::path fuzz_file(const char* name, const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz_folder() / name;
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  return file;
}

/// Calls `read`; what it throws beside Expected ends the fuzzer with the input that did it.
template <class Expected, class Read>
void may_refuse(Read read) {
  try {
    read();
  } catch (const Expected& error) {
    if (std::string_view(error.what()).empty()) std::abort();  // a refusal that says nothing
  }
}

}  // namespace talus::testing
