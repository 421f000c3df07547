// What made a file: the version, source, compiler, libraries and machine, for every output we write.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace talus {

/// Version, git hash and dirty flag, compiler, flags, build type, library versions, host, CPU and time.
nlohmann::json provenance();

/// "talus 0.1.0 (git 1a2b3c4, dirty) g++ 12.2.0 Release".
std::string version_line(std::string_view program);

/// That line, and below it the compiler's flags, the libraries and the machine, for --version.
std::string version_text(std::string_view program);

/// "talus 0.1.0 solver 1a2b3c4d5e6f7a8b g++ 12.2.0 Release": what decides the solver's results and nothing else, so that runs of one such
/// text need not be made again. The hash is over the solver's sources and the compiler's flags.
std::string solver_line();

/// What a program was called with, as text that JSON can hold (utf8).
std::string command_line_of(int argc, char** argv);

/// The text with U+FFFD for what is not UTF-8, as the names of files need not be.
std::string utf8(std::string_view text);

/// SHA-256 of an input text, as hex digits: the name of an input in results.
std::string sha256(std::string_view content);

/// One name for all that lies in a folder: the names and contents of its files, in order. Throws InputError for a file
/// that cannot be read.
std::string sha256_of_folder(const std::filesystem::path& folder);

}  // namespace talus
