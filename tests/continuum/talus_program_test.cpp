// The program `talus` as a user meets it: runs, help, and errors with their exit codes.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "analysis/snapshot.h"
#include "continuum/files/atomic_file.h"
#include "tests/program.h"

namespace talus {
namespace {

using ::testing::HasSubstr;
using testing::run_program;
using testing::TestFolder;

const std::string scene_file = TALUS_SOURCE_DIR "/tests/continuum/data/small_column.toml";

std::string small_scene(const std::string& end) {
  return testing::replaced(read_file(scene_file), "end_s = 0.045", "end_s = " + end);
}

TEST(TalusProgram, RunsASceneToSnapshotsAndABudget) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  std::ofstream(folder / "scene.toml") << small_scene("0.045");
  const auto result =
      run_program({"talus", "run", (folder / "scene.toml").string(), "--output", (folder / "out").string()});
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const auto series = analysis::read_snapshots(folder / "out" / "snapshots.h5");
  ASSERT_EQ(series.size(), 6u);
  EXPECT_EQ(series.front().time, 0.0);
  EXPECT_NEAR(series.back().time, 0.045, 1e-12);
  const auto run = nlohmann::json::parse(read_file(folder / "out" / "run.json"));
  EXPECT_EQ(run["budget"]["mass_error"], 0.0);
  EXPECT_EQ(run["budget"]["cap_hits"], 0);
  EXPECT_EQ(run["particles"], 200);
  EXPECT_TRUE(run["provenance"].contains("git_hash"));
  EXPECT_GT(run["budget"]["friction_iterations"], 0);
}

TEST(TalusProgram, CapsThatAreHitAreToldAndCounted) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  std::ofstream(folder / "scene.toml") << small_scene("0.02") << "[solver]\nmax_friction_iterations = 1\n";
  const auto result =
      run_program({"talus", "run", (folder / "scene.toml").string(), "--output", (folder / "out").string()});
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("stopped at their iteration cap"));
  const auto run = nlohmann::json::parse(read_file(folder / "out" / "run.json"));
  EXPECT_GT(run["budget"]["cap_hits"], 0);
  EXPECT_EQ(run["budget"]["converged"], false);
}

TEST(TalusProgram, BadInputIsOneErrorAndExitCodeTwo) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  std::ofstream(folder / "scene.toml") << small_scene("-1.0");
  std::ofstream(folder / "blocked") << "";
  const auto run = [&](const std::string& scene, const std::string& output) {
    return run_program({"talus", "run", (folder / scene).string(), "--output", (folder / output).string()});
  };
  auto result = run("scene.toml", "out");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("'time.end_s' = -1: must be greater than 0"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));

  result = run("absent.toml", "out");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("no such file"));

  std::ofstream(folder / "scene.toml") << small_scene("0.02");
  result = run("scene.toml", "blocked/out");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("cannot make this folder"));

  EXPECT_EQ(run_program({"talus", "fly"}).exit_code, 2);
}

TEST(TalusProgram, KilledHalfWayLeavesNoSnapshotsUnderTheirFinalName) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  std::ofstream(folder / "scene.toml") << small_scene("1000.0");
  // What an earlier run left must not pass for this one's.
  std::filesystem::create_directories(folder / "out");
  for (const char* old : {"snapshots.h5", "run.json"}) std::ofstream(folder / "out" / old) << "old";
  const auto result = run_program(
      {"talus", "run", (folder / "scene.toml").string(), "--output", (folder / "out").string()}, 2.0);
  EXPECT_TRUE(result.timed_out);
  EXPECT_TRUE(std::filesystem::exists(folder / "out"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out" / "snapshots.h5"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out" / "run.json"));
}

TEST(TalusProgram, SaysWhatItIs) {
  EXPECT_THAT(run_program({"talus", "--version"}).output, HasSubstr("talus 0.1.0 (git "));
  EXPECT_THAT(run_program({"talus", "run", "--help"}).output, HasSubstr("--output"));
}

}  // namespace
}  // namespace talus
