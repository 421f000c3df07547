// Renames that last.
#pragma once

#include <filesystem>
#include <system_error>

namespace talus {

/// Renames `from`, whole and on the disk, to `to` in the same folder, in the place of what is there, and flushes the folder, so
/// that the new name is still there after a loss of power. Returns why that failed, if it did; where it was the flush, the new
/// name stands all the same.
std::error_code put_in_place(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace talus
