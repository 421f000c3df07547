// What toml++ would choke on, or tell badly, told before it reads.
#pragma once

#include <filesystem>
#include <string_view>

namespace talus {

/// Throws InputError with file and line for control characters, and for keys of more than 32 parts.
void refuse_hostile_text(const std::filesystem::path& file, std::string_view text);

}  // namespace talus
