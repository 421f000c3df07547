// The corpora of quadratic programs are written by one command, and replayed by another.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>

#include "continuum/qp/problem_file.h"
#include "tests/program.h"

namespace talus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::run_program;

const std::string corpora = TALUS_BINARY_DIR "/tests/qp_corpora";
const std::string bench = TALUS_BINARY_DIR "/tests/qp_replay_bench";

std::vector<std::filesystem::path> problems_below(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".h5") files.push_back(entry.path());
  }
  return files;
}

std::filesystem::path first_friction_problem(const std::filesystem::path& folder) {
  auto files = problems_below(folder);
  std::sort(files.begin(), files.end());
  const auto found = std::find_if(files.begin(), files.end(), [](const auto& file) {
    return file.filename().string().ends_with("friction.h5");
  });
  return found == files.end() ? folder : *found;
}

double largest_start(const std::filesystem::path& file) {
  return std::visit([](const auto& problem) { return problem.start.abs().maxCoeff(); }, read_problem(file));
}

TEST(QpCorpora, AreWrittenToldAndReplayed) {
  const testing::TestFolder temporary;
  const auto folder = temporary.path() / "corpora";
  const auto made = run_program(
      {corpora, folder.string(), "--only", "impact", "--only", "cold_start", "--coarser", "4"}, 60.0);
  ASSERT_EQ(made.exit_code, 0) << made.output;
  EXPECT_THAT(read_file(folder / "README.md"),
              AllOf(HasSubstr("| `impact` | A block of sand hits a bed"), HasSubstr("| `cold_start` |")));
  EXPECT_FALSE(std::filesystem::exists(folder / "full_flight"));
  EXPECT_GE(problems_below(folder / "impact").size(), 4u);       // friction and pressure, twice
  EXPECT_GE(problems_below(folder / "cold_start").size(), 12u);  // and six times
  const auto replayed = run_program({bench, "--benchmark_min_time=0.0001", folder.string()}, 120.0);
  EXPECT_EQ(replayed.exit_code, 0) << replayed.output;
  for (const auto& file : problems_below(folder)) EXPECT_THAT(replayed.output, HasSubstr(file.string()));
  // A cold start is from no stress, an impact from some.
  EXPECT_EQ(largest_start(first_friction_problem(folder / "cold_start")), 0.0);
  EXPECT_GT(largest_start(first_friction_problem(folder / "impact")), 0.0);
}

TEST(QpCorpora, ReplaceWhatAnEarlierRunLeft) {
  const testing::TestFolder temporary;
  const auto old = temporary.path() / "heap_at_rest" / "qp" / "step_000007";
  std::filesystem::create_directories(old);
  std::ofstream(old / "00_friction.h5") << "old";
  const auto made =
      run_program({corpora, temporary.path().string(), "--only", "cold_start", "--coarser", "4"}, 60.0);
  EXPECT_EQ(made.exit_code, 0) << made.output;
  EXPECT_FALSE(std::filesystem::exists(old));
  EXPECT_TRUE(std::filesystem::exists(temporary.path() / "cold_start"));
}

TEST(QpCorpora, BadInputIsOneErrorAndExitCodeTwo) {
  const testing::TestFolder temporary;
  std::ofstream(temporary.path() / "something") << "";
  const auto blocked = run_program({corpora, (temporary.path() / "something" / "new").string()}, 60.0);
  EXPECT_EQ(blocked.exit_code, 2);
  EXPECT_THAT(blocked.output, HasSubstr("cannot make this folder"));
  const auto unknown =
      run_program({corpora, (temporary.path() / "new").string(), "--only", "avalanche"}, 60.0);
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.output, HasSubstr("--only avalanche: there is no such corpus"));
}

}  // namespace
}  // namespace talus
