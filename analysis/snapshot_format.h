// What the writer and the reader of snapshot files share; not for other code.
#pragma once

#include <H5Cpp.h>
#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <new>
#include <string_view>

#include "analysis/snapshot.h"

namespace talus::analysis {

inline constexpr const char* format_name = "talus-snapshots";
inline constexpr int format_version = 1;

/// An error about `file`.
SnapshotError snapshot_error(const std::filesystem::path& file, std::string_view what);

/// The rules of one frame, for writing and reading alike. `previous` is the time of the frame before.
void check_frame(const std::filesystem::path& file, std::size_t index, const Snapshot& snapshot,
                 double previous);

/// Runs `action`; whatever HDF5 says goes into one SnapshotError that names the file.
template <typename Action>
auto translating_errors(const std::filesystem::path& file, std::string_view doing, Action&& action) {
  H5::Exception::dontPrint();
  try {
    return action();
  } catch (const H5::Exception& exception) {
    throw snapshot_error(file, fmt::format("{}: HDF5 says '{}' in {}", doing, exception.getDetailMsg(),
                                           exception.getFuncName()));
  } catch (const std::bad_alloc&) {
    throw snapshot_error(file, fmt::format("{}: the file claims more data than there is memory", doing));
  }
}

}  // namespace talus::analysis
