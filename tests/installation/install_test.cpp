// What `cmake --install` gives: programs that find their data, and a library that an external program of ten lines can use.
#include <gmock/gmock.h>

#include "tests/program.h"

namespace talus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_program;
using Path = std::filesystem::path;

class Installed : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new testing::TestFolder;
    const auto result = run_program({"cmake", "--install", TALUS_BINARY_DIR, "--prefix", prefix().string()});
    ASSERT_EQ(result.exit_code, 0) << result.output;
  }
  static void TearDownTestSuite() { delete folder_; }
  static Path prefix() { return folder_->path() / "usr"; }
  static std::string program(const std::string& name) { return (prefix() / "bin" / name).string(); }

  static testing::TestFolder* folder_;
};
testing::TestFolder* Installed::folder_ = nullptr;

TEST_F(Installed, ProgramsTellTheirVersion) {
  for (const char* name : {"talus", "talus-dem", "talus-validate"})
    EXPECT_THAT(run_program({program(name), "--version"}).output,
                HasSubstr(std::string(name) + " 0.1.0 (git "));
}

/// Data beside the programs, not in the tree that they were built from: what is taken away there is missed.
TEST_F(Installed, ProgramsUseTheDataBesideThem) {
  const auto suites = run_program({program("talus-validate"), "list"});
  EXPECT_EQ(suites.exit_code, 0) << suites.output;
  EXPECT_THAT(suites.output, AllOf(HasSubstr("smoke"), HasSubstr("reference")));
  const auto runs = run_program({program("talus-dem"), "list"});
  EXPECT_EQ(runs.exit_code, 0) << runs.output;
  EXPECT_THAT(runs.output, HasSubstr("stored"));

  std::filesystem::remove(prefix() / "share/talus/validation/suites/smoke.toml");
  EXPECT_THAT(run_program({program("talus-validate"), "list"}).output, Not(HasSubstr("smoke")));
}

TEST_F(Installed, AnExternalProgramFindsTheLibrary) {
  const Path build = folder_->path() / "build";
  const auto configured =
      run_program({"cmake", "-S", TALUS_SOURCE_DIR "/tests/installation/external", "-B", build.string(), "-G",
                   "Ninja", "-DCMAKE_PREFIX_PATH=" + prefix().string()});
  ASSERT_EQ(configured.exit_code, 0) << configured.output;
  const auto built = run_program({"cmake", "--build", build.string()});
  ASSERT_EQ(built.exit_code, 0) << built.output;
  const auto ran = run_program(
      {(build / "external").string(), TALUS_SOURCE_DIR "/tests/continuum/data/small_column.toml"});
  EXPECT_EQ(ran.exit_code, 0);
  EXPECT_EQ(ran.output, "200 particles at 0.02 s\n");
}

}  // namespace
}  // namespace talus
