// Files that are either whole or not there: written beside their place, flushed to the disk, then renamed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace talus {

/// Replaces `file` by `content`. Throws InputError when the folder cannot be written to or the disk is full;
/// the old content, if any, is then untouched.
void write_file_atomically(const std::filesystem::path& file, std::string_view content);

/// A text that grows while a program runs, as `file` + ".partial", and has its own name once it is whole. What an
/// unfinished run leaves can be read.
class GrowingFile {
 public:
  /// Starts with `content`. All of it throws InputError when the text cannot be written.
  GrowingFile(std::filesystem::path file, std::string_view content);
  /// Goes on with what an unfinished run left, cut to its first `bytes`, at least 1. Throws InputError when there are not so many.
  GrowingFile(std::filesystem::path file, std::int64_t bytes);
  void append(std::string_view content);
  /// Flushes all so far to the disk; returns how many bytes that are.
  std::int64_t save();
  void finish();

 private:
  std::filesystem::path file_, temporary_;
  std::ofstream out_;
};

/// The whole content of `file`. Throws InputError when it cannot be read.
std::string read_file(const std::filesystem::path& file);

/// Makes `folder` (and its parents) and proves that files can be written there. Throws InputError.
void make_writable_folder(const std::filesystem::path& folder);

}  // namespace talus
