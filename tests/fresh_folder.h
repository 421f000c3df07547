// A place for a test's files.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace talus::testing {

/// An empty folder of this name among the temporary files of this process; ctest runs several at once.
inline std::filesystem::path fresh_folder(const std::string& name) {
  const auto folder =
      std::filesystem::path(::testing::TempDir()) / ("talus_test_" + std::to_string(::getpid())) / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace talus::testing
