// talus-validate as a user meets it: the whole chain on a hundred grains with the real codes, the report in a
// real browser, and every way it can go wrong that we know of.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "analysis/snapshot.h"
#include "tests/program.h"
#include "tests/validation/browser.h"

namespace talus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_program;
using testing::TestFolder;

const std::filesystem::path source = TALUS_SOURCE_DIR;
const std::string program = (std::filesystem::path(TALUS_BINARY_DIR) / "bin" / "talus-validate").string();
const std::string tiny_suite = (source / "tests/validation/data/tiny_suite.toml").string();

testing::ProgramResult validate(const std::string& command, const std::string& suite,
                                const std::filesystem::path& output) {
  return run_program({"talus-validate", command, suite, "--output", output.string(), "--jobs", "2"});
}

/// The tiny suite and its case, written elsewhere with some text replaced; returns the suite's path.
std::string changed_suite(const std::filesystem::path& folder, const std::string& from,
                          const std::string& to) {
  std::string suite = read_file(tiny_suite),
              column = read_file(source / "tests/dem_cases/data/tiny_column.toml");
  const auto replace = [](std::string& text, const std::string& old, const std::string& now) {
    const auto at = text.find(old);
    if (at != std::string::npos) text.replace(at, old.size(), now);
    return at != std::string::npos;
  };
  replace(suite, "../../../dem_cases/shear_cell", (source / "dem_cases/shear_cell").string());
  replace(suite, "../../dem_cases/data/tiny_column.toml", "column.toml");
  EXPECT_TRUE(replace(suite, from, to) || replace(column, from, to)) << from;
  std::ofstream(folder / "suite.toml") << suite;
  std::ofstream(folder / "column.toml") << column;
  return (folder / "suite.toml").string();
}

/// One run of the chain, shared by the tests that look at what it left.
class WholeChain : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TestFolder>();
    output_ = folder_->path();
    result_ = validate("run", tiny_suite, output_);
  }
  static void TearDownTestSuite() { folder_.reset(); }
  void SetUp() override { ASSERT_EQ(result_.exit_code, 0) << result_.output; }
  static nlohmann::json results() { return nlohmann::json::parse(read_file(output_ / "results.json")); }

  static inline std::unique_ptr<TestFolder> folder_;
  static inline std::filesystem::path output_;
  static inline testing::ProgramResult result_;
};

TEST_F(WholeChain, ShowsProgressAndTheTable) {
  EXPECT_THAT(result_.output, AllOf(HasSubstr("6 runs, 2 at a time"), HasSubstr("yade seed 1 finished"),
                                    HasSubstr("centre_of_mass"), HasSubstr("verdict: ")));
}

TEST_F(WholeChain, ResultsHoldEveryRunWithItsProvenance) {
  const auto all = results();
  EXPECT_EQ(all["schema_version"], 1);
  EXPECT_EQ(all["complete"], true);
  for (const char* key : {"git_hash", "compiler", "libraries", "programs", "command_line", "suite_hash"}) {
    EXPECT_TRUE(all["provenance"].contains(key)) << key;
  }
  EXPECT_EQ(all["provenance"]["programs"]["liggghts"], "3.8.0");
  const auto& one = all["cases"][0];
  EXPECT_EQ(one["input_hash"].get<std::string>().size(), 64u);
  EXPECT_NEAR(one["calibration"]["friction_angle_deg"].get<double>(), 31.1, 1e-9);
  ASSERT_EQ(one["runs"].size(), 6u);
  for (const auto& run : one["runs"]) {
    EXPECT_EQ(run["status"], "ok");
    EXPECT_GT(run["cpu_s"].get<double>(), 0.0);
    EXPECT_GT(run["wall_s"].get<double>(), 0.0);
    EXPECT_GT(run["time_step_s"].get<double>(), 0.0);
    EXPECT_EQ(run["input_hash"].get<std::string>().size(), 64u);
    EXPECT_GT(run["observables"]["x95"].get<double>(), 1.0);
    EXPECT_LT(run["observables"]["x95"].get<double>(), 3.5);
    EXPECT_EQ(run["curves"]["time"][0], 0.0);
    const bool discrete = run["backend"] != "continuum";
    EXPECT_EQ(run["preflight"].is_object(), discrete);
    EXPECT_EQ(run["solver"].is_object(), !discrete);
    if (discrete) {
      EXPECT_LT(run["preflight"]["rayleigh_fraction"].get<double>(), 0.3);
    }
  }
}

TEST_F(WholeChain, BothDiscreteCodesStartFromTheSamePackingAndAgree) {
  const auto runs = results()["cases"][0]["runs"];
  const auto find = [&](const std::string& backend, int seed) {
    for (const auto& run : runs) {
      if (run["backend"] == backend && run["seed"] == seed) return run;
    }
    return nlohmann::json();
  };
  for (const int seed : {1, 2}) {
    const auto a = find("liggghts", seed), b = find("yade", seed);
    EXPECT_EQ(a["count"], b["count"]);
    // A hundred grains scatter by some per cent; a wrong contact law or wall shows far more.
    EXPECT_NEAR(
        b["observables"]["centre_of_mass"].get<double>() / a["observables"]["centre_of_mass"].get<double>(),
        1.0, 0.1);
  }
}

TEST_F(WholeChain, EveryRunLeavesNeutralSnapshots) {
  for (const std::string run : {"continuum_seed1", "liggghts_seed1", "yade_seed2"}) {
    const auto folder = output_ / "runs" / "tiny_column" / run;
    const auto series = analysis::read_snapshots(folder / "snapshots.h5");
    EXPECT_EQ(series.size(), 41u) << run;
    EXPECT_EQ(series.front().time, 0.0);
    EXPECT_NEAR(series.back().time, 0.28, 1e-9);
    EXPECT_TRUE(std::filesystem::exists(folder / "snapshots.xdmf"));
  }
}

TEST_F(WholeChain, ReportDrawsInChromium) {
  const std::string page = testing::drawn_page(output_ / "report.html");
  EXPECT_THAT(page, AllOf(HasSubstr("data-charts=\"3\""), HasSubstr("data-errors=\"0\"")));
  EXPECT_THAT(page, HasSubstr("A column of a hundred grains"));
}

TEST_F(WholeChain, CheckSaysTheVerdictByItsExitCode) {
  const auto verdict = results()["verdict"].get<std::string>();
  const auto result = run_program({"talus-validate", "check", "--output", output_.string()});
  EXPECT_EQ(result.exit_code, verdict == "PASS" ? 0 : verdict == "FAIL" ? 1 : 3);
  EXPECT_THAT(result.output, HasSubstr("verdict: " + verdict));
}

TEST_F(WholeChain, ReportIsMadeAgainFromTheStoredRuns) {
  const std::string before = read_file(output_ / "report.html");
  std::filesystem::remove(output_ / "report.html");
  const auto result =
      run_program({"/usr/bin/env", "PATH=/nowhere", program, "report", "--output", output_.string()});
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(read_file(output_ / "report.html"), before);
}

TEST_F(WholeChain, CheckJudgesTheRunsNotTheWrittenVerdict) {
  const TestFolder temporary;
  const auto exit_code_of = [&](const nlohmann::json& changed) {
    std::ofstream(temporary.path() / "results.json") << changed.dump();
    return run_program({"talus-validate", "check", "--output", temporary.path().string()}).exit_code;
  };
  auto changed = results();
  changed["verdict"] = "PASS";
  for (auto& run : changed["cases"][0]["runs"]) {
    run["observables"]["at_rest"] = true;  // a last grain may roll on in so small a column
    if (run["backend"] == "continuum") run["observables"]["x95"] = 9.0;
  }
  EXPECT_EQ(exit_code_of(changed), 1);
  for (auto& run : changed["cases"][0]["runs"]) run["observables"]["at_rest"] = false;
  EXPECT_EQ(exit_code_of(changed), 3);
  changed["cases"] = nlohmann::json::array();
  EXPECT_EQ(exit_code_of(changed), 3);
  changed.erase("cases");
  EXPECT_EQ(exit_code_of(changed), 2);
}

TEST_F(WholeChain, HalfWrittenResultsAreRefused) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  const std::string whole = read_file(output_ / "results.json");
  std::ofstream(folder / "results.json") << whole.substr(0, whole.size() / 2);
  auto result = run_program({"talus-validate", "check", "--output", folder.string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("not whole"));
  auto incomplete = results();
  incomplete["complete"] = false;
  std::ofstream(folder / "results.json") << incomplete.dump();
  result = run_program({"talus-validate", "check", "--output", folder.string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("not complete"));
}

TEST(ValidateErrors, BadInputIsOneErrorExitCodeTwoAndNothingWritten) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  const auto expect = [&](const std::string& from, const std::string& to, const auto& message) {
    const auto result = validate("run", changed_suite(folder, from, to), folder / "out");
    EXPECT_EQ(result.exit_code, 2) << to;
    EXPECT_THAT(result.output, message);
    EXPECT_EQ(std::count(result.output.begin(), result.output.end(), '\n'), 1) << result.output;
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  };
  expect("density_kg_m3", "densty_kg_m3", AllOf(HasSubstr("column.toml:"), HasSubstr("density_kg_m3")));
  expect("restitution = 0.5", "restitution = 0.5\nstickiness = 1.0",
         AllOf(HasSubstr("stickiness"), HasSubstr("column.toml:")));
  expect("diameter_m = 0.003", "diameter_mm = 3.0",
         AllOf(HasSubstr("diameter_mm"), HasSubstr("column.toml:")));
  expect("time_step_s = 3.5e-5", "time_step_s = 1.4e-4", HasSubstr("Rayleigh"));
  expect("diameter_m = 0.003", "diameter_m = 1e-6",
         AllOf(HasSubstr("grains; at most"), HasSubstr("diameter_m")));
  expect("wall_friction = 0.0", "wall_friction = 0.9", HasSubstr("must be at most friction"));
  expect("kind = \"column_collapse\"", "kind = \"avalanche\"", HasSubstr("must be one of: column_collapse"));
  expect("[protocol]", "[proto", AllOf(HasSubstr("column.toml:"), HasSubstr("not valid TOML")));
  // Half a case file: everything from the middle on is gone.
  const std::string tail = read_file(source / "tests/dem_cases/data/tiny_column.toml");
  expect(tail.substr(tail.find("[contact]")), "", HasSubstr("needs a table [protocol]"));
}

TEST(ValidateErrors, AMissingProgramIsNamedWithItsPackage) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  std::filesystem::create_symlink("/usr/bin/liggghts", folder / "liggghts");
  const auto result = run_program({"/usr/bin/env", "PATH=" + folder.string(), program, "run", tiny_suite,
                                   "--output", (folder / "out").string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, AllOf(HasSubstr("yade"), HasSubstr("apt-get install yade")));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(ValidateErrors, AFolderThatCannotBeWrittenIsAnError) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  std::ofstream(folder / "file") << "";
  const auto result = validate("run", tiny_suite, folder / "file" / "out");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("cannot make this folder"));
}

TEST(ValidateErrors, ARunOverItsTimeLimitFailsTheSuiteAndLeavesNoResults) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  const auto result =
      validate("run", changed_suite(folder, "time_limit_s = 120.0", "time_limit_s = 1.0"), folder / "out");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, AllOf(HasSubstr("yade seed 1"), HasSubstr("time limit of 1 s")));
  EXPECT_FALSE(std::filesystem::exists(folder / "out" / "results.json"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out" / "runs" / "tiny_column" / "yade_seed1"));
}

TEST(ValidateErrors, AnInterruptedRunLeavesNothingThatPassesForWhole) {
  const TestFolder temporary;
  const auto& output = temporary.path();
  // Results of an earlier run must not survive as if they were this run's.
  std::ofstream(output / "results.json") << "{}";
  std::ofstream(output / "report.html") << "old";
  const auto result = run_program({"/usr/bin/timeout", "--preserve-status", "--signal=INT", "3", program,
                                   "run", tiny_suite, "--output", output.string()});
  EXPECT_EQ(result.exit_code, 130) << result.output;
  EXPECT_THAT(result.output, HasSubstr("interrupted"));
  EXPECT_FALSE(std::filesystem::exists(output / "results.json"));
  EXPECT_FALSE(std::filesystem::exists(output / "report.html"));
  EXPECT_FALSE(std::filesystem::exists(output / "runs" / "tiny_column" / "yade_seed1"));
  const auto check = run_program({"talus-validate", "check", "--output", output.string()});
  EXPECT_EQ(check.exit_code, 2);
}

TEST(ValidateProgram, ListsSuitesAndExplainsItself) {
  EXPECT_THAT(run_program({"talus-validate", "list"}).output, HasSubstr("smoke"));
  EXPECT_THAT(run_program({"talus-validate", "--help"}).output,
              AllOf(HasSubstr("Exit codes"), HasSubstr("check")));
  EXPECT_THAT(run_program({"talus-validate", "--version"}).output, HasSubstr("talus-validate 0.1.0"));
  EXPECT_EQ(run_program({"talus-validate", "judge"}).exit_code, 2);
}

}  // namespace
}  // namespace talus
