// Files are whole or not there.
#include "continuum/files/atomic_file.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>

#include "continuum/files/checked_table.h"
#include "continuum/files/provenance.h"
#include "tests/test_folder.h"

#include <nlohmann/json.hpp>

namespace talus {
namespace {

TEST(AtomicFile, ReplacesTheOldContentAndLeavesNothingElse) {
  const testing::TestFolder temporary;
  const auto& folder = temporary.path();
  write_file_atomically(folder / "a", "old");
  write_file_atomically(folder / "a", "new");
  EXPECT_EQ(read_file(folder / "a"), "new");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
}

TEST(AtomicFile, AFullDiskLeavesTheOldContent) {
  // /dev/full takes an open and refuses every write: put it where the temporary file would go.
  const testing::TestFolder temporary;
  const auto& folder = temporary.path();
  write_file_atomically(folder / "a", "old");
  std::filesystem::create_symlink("/dev/full", folder / ("a.partial-" + std::to_string(::getpid())));
  EXPECT_THROW(write_file_atomically(folder / "a", "new"), InputError);
  EXPECT_EQ(read_file(folder / "a"), "old");
}

TEST(AtomicFile, WhereAFolderStandsNothingIsPutAndNothingIsLeft) {
  const testing::TestFolder temporary;
  const auto& folder = temporary.path();
  std::filesystem::create_directories(folder / "a" / "below");
  EXPECT_THROW(write_file_atomically(folder / "a", "new"), InputError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
}

TEST(AtomicFile, AFolderThatCannotBeMadeIsAnError) {
  const testing::TestFolder temporary;
  const auto& folder = temporary.path();
  write_file_atomically(folder / "file", "");
  EXPECT_THROW(make_writable_folder(folder / "file" / "below"), InputError);
  EXPECT_THROW(make_writable_folder("/proc/nowhere"), InputError);
  EXPECT_THROW(read_file(folder / "absent"), InputError);
}

TEST(AtomicFile, TryingAFolderLeavesItAsItIs) {
  const testing::TestFolder temporary;
  const auto& folder = temporary.path();
  const auto before = std::filesystem::last_write_time(folder) - std::chrono::hours(1);
  std::filesystem::last_write_time(folder, before);
  make_writable_folder(folder);
  EXPECT_EQ(std::filesystem::last_write_time(folder), before) << "a file was in it for a moment";
  EXPECT_THROW(make_writable_folder("/sys"), InputError);
}

TEST(Provenance, NamesSourceCompilerAndLibraries) {
  const auto made_by = provenance();
  for (const char* key :
       {"version", "git_hash", "git_dirty", "compiler", "build_type", "libraries", "cpu", "time_utc"}) {
    EXPECT_TRUE(made_by.contains(key)) << key;
  }
  EXPECT_EQ(sha256("abc"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");  // FIPS 180-2, B.1
}

TEST(Provenance, TheVersionTellsFlagsLibrariesAndMachine) {
  const std::string text = version_text("talus");
  EXPECT_TRUE(text.starts_with(version_line("talus") + "\n"));
  const auto made_by = provenance();
  for (const std::string part : {made_by["compiler_flags"], made_by["libraries"]["eigen"], made_by["cpu"]})
    EXPECT_NE(text.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace talus
