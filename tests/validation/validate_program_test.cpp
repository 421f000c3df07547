// talus-validate as a user meets it: the whole chain on a hundred grains with the real codes, the report in a
// real browser, and every way it can go wrong that we know of.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

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
                                const std::filesystem::path& output,
                                const std::vector<std::string>& more = {}) {
  std::vector<std::string> line{"talus-validate", command, suite, "--output", output.string(), "--jobs", "2"};
  line.insert(line.end(), more.begin(), more.end());
  return run_program(line);
}

/// A command on stored results, with a baseline folder of the test's own.
testing::ProgramResult judged(const std::string& command, const std::filesystem::path& output,
                              const std::filesystem::path& baseline,
                              const std::vector<std::string>& more = {}) {
  std::vector<std::string> line{"talus-validate", "--baseline", baseline.string(),
                                command,          "--output",   output.string()};
  line.insert(line.end(), more.begin(), more.end());
  return run_program(line);
}

nlohmann::json json_of(const std::filesystem::path& file) { return nlohmann::json::parse(read_file(file)); }

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
  EXPECT_THAT(result_.output,
              AllOf(HasSubstr("8 of 8 runs to make"), HasSubstr("yade seed 1 finished"),
                    HasSubstr("centre_of_mass"), HasSubstr("truth verdict: "), HasSubstr("drift verdict: ")));
}

TEST_F(WholeChain, ResultsHoldEveryRunWithItsProvenance) {
  const auto all = results();
  EXPECT_EQ(all["schema_version"], 2);
  EXPECT_EQ(all["complete"], true);
  for (const char* key : {"git_hash", "compiler", "libraries", "programs", "command_line", "suite_hash"}) {
    EXPECT_TRUE(all["provenance"].contains(key)) << key;
  }
  EXPECT_EQ(all["provenance"]["programs"]["liggghts"], "3.8.0");
  const auto& one = all["points"][0];
  EXPECT_EQ(one["name"], "tiny_column/tiny");
  EXPECT_EQ(one["family"], "column collapse");
  EXPECT_EQ(one["input_hash"].get<std::string>().size(), 64u);
  EXPECT_GT(one["calibration"]["friction_angle_deg"].get<double>(), 20.0);
  std::map<std::string, int> codes;
  for (const auto& run : one["runs"]) {
    ++codes[run["code"]];
    EXPECT_EQ(run["status"], "ok");
    EXPECT_EQ(run["origin"], "run");
    EXPECT_GT(run["cpu_s"].get<double>(), 0.0);
    EXPECT_GT(run["wall_s"].get<double>(), 0.0);
    EXPECT_GT(run["time_step_s"].get<double>(), 0.0);
    EXPECT_EQ(run["input_hash"].get<std::string>().size(), 64u);
    EXPECT_GT(run["observables"]["x95"].get<double>(), 1.0);
    EXPECT_LT(run["observables"]["x95"].get<double>(), 3.5);
    EXPECT_EQ(run["curves"]["time"][0], 0.0);
    const bool discrete = !run["code"].get<std::string>().starts_with("continuum");
    EXPECT_EQ(run["preflight"].is_object(), discrete);
    EXPECT_EQ(run["solver"].is_object(), !discrete);
    if (discrete) {
      EXPECT_LT(run["preflight"]["rayleigh_fraction"].get<double>(), 0.3);
    }
  }
  const std::map<std::string, int> expected{
      {"continuum", 2}, {"continuum_coarse", 1}, {"continuum_short_steps", 1}, {"liggghts", 2}, {"yade", 2}};
  EXPECT_EQ(codes, expected);
}

/// The run of a code and seed.
nlohmann::json run_of(const nlohmann::json& results, const std::string& code, int seed) {
  for (const auto& run : results["points"][0]["runs"]) {
    if (run["code"] == code && run["seed"] == seed) return run;
  }
  return {};
}

TEST_F(WholeChain, TheRefinementIsWhatItSays) {
  const auto standard = run_of(results(), "continuum", 1), coarse = run_of(results(), "continuum_coarse", 1),
             short_steps = run_of(results(), "continuum_short_steps", 1);
  EXPECT_NEAR(coarse["thickness_m"].get<double>() / standard["thickness_m"].get<double>(), 2.0, 1e-9);
  EXPECT_LT(short_steps["time_step_s"].get<double>(),
            0.7 * standard["time_step_s"].get<double>());  // steps fill frames

  const auto numerical = results()["points"][0]["truth"][0]["u_numerical"];
  for (const char* part : {"seeds", "grid", "time_step", "combined"})
    EXPECT_TRUE(numerical[part].is_number()) << part;
}

TEST_F(WholeChain, BothDiscreteCodesStartFromTheSamePackingAndAgree) {
  for (const int seed : {1, 2}) {
    const auto a = run_of(results(), "liggghts", seed), b = run_of(results(), "yade", seed);
    EXPECT_EQ(a["count"], b["count"]);
    // A hundred grains scatter by some per cent; a wrong contact law or wall shows far more.
    EXPECT_NEAR(
        b["observables"]["centre_of_mass"].get<double>() / a["observables"]["centre_of_mass"].get<double>(),
        1.0, 0.1);
  }
}

TEST_F(WholeChain, EveryRunLeavesNeutralSnapshots) {
  for (const std::string run : {"continuum_seed1", "liggghts_seed1", "yade_seed2"}) {
    const auto folder = output_ / "runs" / "tiny_column" / "tiny" / run;
    const auto series = analysis::read_snapshots(folder / "snapshots.h5");
    EXPECT_EQ(series.size(), 41u) << run;
    EXPECT_EQ(series.front().time, 0.0);
    EXPECT_NEAR(series.back().time, 0.28, 1e-9);
    EXPECT_TRUE(std::filesystem::exists(folder / "snapshots.xdmf"));
  }
}

TEST_F(WholeChain, ReportDrawsInChromium) {
  const std::string page = testing::drawn_page(output_ / "report.html");
  EXPECT_THAT(page, AllOf(HasSubstr("data-errors=\"0\""), Not(HasSubstr("data-charts=\"0\""))));
  EXPECT_THAT(page, HasSubstr("A column of a hundred grains"));
}

TEST_F(WholeChain, CheckSaysTheVerdictByItsExitCode) {
  const TestFolder baseline;
  const auto verdict = results()["verdict"].get<std::string>();
  const auto result = judged("check", output_, baseline.path(), {"--gate", "truth"});
  EXPECT_EQ(result.exit_code, verdict == "PASS" ? 0 : verdict == "FAIL" ? 1 : 3);
  EXPECT_THAT(result.output, HasSubstr("truth verdict: " + verdict));
}

TEST_F(WholeChain, UnchangedRunsAreNotMadeAgainAndForceMakesThem) {
  const auto again = validate("run", tiny_suite, output_, {"--no-report"});
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_THAT(again.output, HasSubstr("0 of 8 runs to make"));
  const auto one =
      validate("run", tiny_suite, output_, {"--force", "--only", "tiny_column/tiny/continuum_coarse"});
  EXPECT_THAT(one.output, HasSubstr("1 of 1 runs to make"));
  EXPECT_TRUE(std::filesystem::exists(output_ / "results.json"));
  EXPECT_EQ(validate("run", tiny_suite, output_, {"--only", "tiny_column/a"}).exit_code, 2);
}

TEST_F(WholeChain, ListTellsCostAndWhatIsThere) {
  const TestFolder temporary;
  const auto file = temporary.path() / "list.json";
  const auto listed = run_program(
      {"talus-validate", "list", tiny_suite, "--output", output_.string(), "--json", file.string()});
  EXPECT_EQ(listed.exit_code, 0) << listed.output;
  const auto list = json_of(file);
  ASSERT_EQ(list["runs"].size(), 8u);
  for (const auto& run : list["runs"]) {
    EXPECT_EQ(run["state"], "stored");
    EXPECT_GT(run["expected_cpu_s"].get<double>(), 0.0);
    EXPECT_GT(run["memory_mb"].get<double>(), 10.0);
    EXPECT_TRUE(std::filesystem::exists(output_ / run["folder"].get<std::string>() / "record.json"));
  }
  run_program({"talus-validate", "list", tiny_suite, "--output", (temporary.path() / "none").string(),
               "--json", file.string()});
  EXPECT_EQ(json_of(file)["runs"][0]["state"], "missing");
}

TEST_F(WholeChain, ReportIsMadeAgainOfflineInAllFormats) {
  auto result = run_program({"talus-validate", "report", "--output", output_.string()});
  EXPECT_EQ(result.exit_code, 0) << result.output;
  const std::string before = read_file(output_ / "report.html");
  std::filesystem::remove(output_ / "report.html");
  result = run_program({"/usr/bin/env", "PATH=/nowhere", program, "report", "--output", output_.string()});
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(read_file(output_ / "report.html"), before);
  result = run_program(
      {"talus-validate", "report", "--output", output_.string(), "--pdf", "--junit", "--markdown"});
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(read_file(output_ / "report.pdf"), ::testing::StartsWith("%PDF"));
  EXPECT_THAT(read_file(output_ / "report.xml"),
              AllOf(HasSubstr("<testsuite"), HasSubstr("tiny_column/tiny")));
  EXPECT_THAT(read_file(output_ / "report.md"), HasSubstr("tiny\\_column/tiny"));
}

TEST_F(WholeChain, PicturesAreKeptAndStandForTheSnapshots) {
  const TestFolder folder;
  const auto output = folder.path() / "copy";
  std::filesystem::copy(output_, output, std::filesystem::copy_options::recursive);
  const auto report = [&] {
    std::filesystem::remove(output / "report.html");
    const auto result = run_program({"talus-validate", "report", "--output", output.string()});
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return read_file(output / "report.html");
  };
  const std::vector<std::filesystem::path> kept(std::filesystem::directory_iterator(output / "pictures"), {});
  ASSERT_EQ(kept.size(), 3u);  // one for each code
  const auto drawn_at = std::filesystem::last_write_time(kept[0]);
  const std::string before = report();
  EXPECT_EQ(std::filesystem::last_write_time(kept[0]), drawn_at);
  write_file_atomically(kept[0], "{");
  write_file_atomically(output / "pictures" / "of_another_run.json", "{}");
  EXPECT_EQ(report(), before) << "a spoilt picture is drawn again";
  EXPECT_NE(read_file(kept[0]), "{");
  EXPECT_FALSE(std::filesystem::exists(output / "pictures" / "of_another_run.json"));
  std::filesystem::remove_all(output / "runs");
  EXPECT_EQ(report(), before) << "no snapshots are needed";
}

TEST_F(WholeChain, TheDriftGateIsGreenOnWhatWasAcceptedAndRedOnWhatMoved) {
  const TestFolder baseline, moved;
  const auto gate = [&](const std::filesystem::path& output) {
    return judged("check", output, baseline.path(), {"--gate", "drift"}).exit_code;
  };
  EXPECT_EQ(gate(output_), 3);
  EXPECT_EQ(judged("accept", output_, baseline.path(), {"--reason", " "}).exit_code, 2);
  const auto accepted = judged("accept", output_, baseline.path(), {"--reason", "the first"});
  EXPECT_EQ(accepted.exit_code, 0) << accepted.output;
  EXPECT_EQ(gate(output_), 0);
  auto changed = results();
  for (auto& run : changed["points"][0]["runs"]) {
    if (run["code"] == "continuum") run["observables"]["x95"] = 1.2 * run["observables"]["x95"].get<double>();
  }
  std::ofstream(moved.path() / "results.json") << changed.dump();
  EXPECT_EQ(gate(moved.path()), 1);
  EXPECT_THAT(judged("check", moved.path(), baseline.path(), {"--annotate"}).output,
              AllOf(HasSubstr("drift: tiny_column/tiny x95"), HasSubstr("::error")));
  const auto compared = run_program({"talus-validate", "compare", output_.string(), moved.path().string(),
                                     "--json", (moved.path() / "compare.json").string()});
  EXPECT_EQ(compared.exit_code, 0) << compared.output;
  EXPECT_THAT(compared.output, HasSubstr("+20.00 %"));
  for (const auto& row : json_of(moved.path() / "compare.json")["rows"]) {
    EXPECT_NEAR(row["change"].get<double>(), row["observable"] == "x95" ? 0.2 : 0.0, 1e-9)
        << row["observable"];
  }
}

TEST_F(WholeChain, CheckJudgesTheRunsNotTheWrittenVerdict) {
  const TestFolder temporary;
  const auto exit_code_of = [&](const nlohmann::json& changed) {
    std::ofstream(temporary.path() / "results.json") << changed.dump();
    return judged("check", temporary.path(), temporary.path(), {"--gate", "truth"}).exit_code;
  };
  auto changed = results();
  changed["verdict"] = "PASS";
  for (auto& run : changed["points"][0]["runs"]) {
    run["observables"]["at_rest"] = true;  // a last grain may roll on in so small a column
    if (run["code"].get<std::string>().starts_with("continuum")) run["observables"]["x95"] = 9.0;
  }
  EXPECT_EQ(exit_code_of(changed), 1);
  for (auto& run : changed["points"][0]["runs"]) run["observables"]["at_rest"] = false;
  EXPECT_EQ(exit_code_of(changed), 3);  // grains that have not come to rest tell nothing
  changed["points"] = nlohmann::json::array();
  EXPECT_EQ(exit_code_of(changed), 3);
  changed.erase("points");
  EXPECT_EQ(exit_code_of(changed), 2);
}

TEST_F(WholeChain, StaleResultsNeverPass) {
  const TestFolder temporary, baseline;
  ASSERT_EQ(judged("accept", output_, baseline.path(), {"--reason", "the first"}).exit_code, 0);
  const auto check_with = [&](const auto& change) {
    auto changed = results();
    change(changed);
    std::ofstream(temporary.path() / "results.json") << changed.dump();
    return judged("check", temporary.path(), baseline.path(), {"--gate", "drift"});
  };
  EXPECT_EQ(check_with([](auto&) {}).exit_code, 0);
  const auto stale = [&](const std::string& what, const auto& change) {
    const auto result = check_with(change);
    EXPECT_EQ(result.exit_code, 3) << what << result.output;
    EXPECT_THAT(result.output, AllOf(HasSubstr("stale: "), HasSubstr(what)));
  };
  stale("tiny_suite.toml has changed", [](auto& r) { r["provenance"]["suite_hash"] = "another"; });
  stale("calibration.toml has changed", [](auto& r) { r["calibration_hash"] = "another"; });
  stale("tiny_column.toml has changed", [](auto& r) { r["points"][0]["input_hash"] = "another"; });
  stale("the program talus has changed", [](auto& r) { r["points"][0]["runs"][0]["version"] = "another"; });
  stale("what the continuum is asked", [](auto& r) { r["points"][0]["runs"][0]["input_hash"] = "another"; });
  stale("is not there", [](auto& r) { r["suite_file"] = "/nowhere/suite.toml"; });
  const auto accepted = judged("accept", temporary.path(), baseline.path(), {"--reason", "try"});
  EXPECT_EQ(accepted.exit_code, 2);
  EXPECT_THAT(accepted.output, HasSubstr("run the suite again before accepting"));
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

TEST_F(WholeChain, MutantsAreTriedAndTheTableSaysWhoWasFoundOut) {
  const TestFolder temporary;
  const auto table = temporary.path() / "mutants.json";
  // The runs that are there serve the unbroken suite.
  const auto result = validate("mutate", tiny_suite, output_, {"--json", table.string()});
  EXPECT_THAT(result.exit_code, ::testing::AnyOf(0, 1)) << result.output;
  const auto mutants = json_of(table);
  ASSERT_EQ(mutants.size(), 2u);
  EXPECT_EQ(mutants[0]["name"], "no_friction");
  EXPECT_TRUE(mutants[0]["killed"].get<bool>()) << result.output;
  EXPECT_EQ(result.exit_code == 0, mutants[1]["killed"].get<bool>());
  EXPECT_EQ(results()["mutants"], mutants);
}

TEST(ValidateErrors, BadInputIsOneErrorExitCodeTwoAndNothingWritten) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  const auto expect = [&](const std::string& from, const std::string& to, const auto& message) {
    const auto result = validate("run", changed_suite(folder, from, to), folder / "out");
    EXPECT_EQ(result.exit_code, 2) << to;
    EXPECT_THAT(result.output, message);
    std::istringstream lines(result.output);  // a fault each, and nothing else
    for (std::string line; std::getline(lines, line);)
      EXPECT_THAT(line, HasSubstr(".toml:")) << result.output;
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
  EXPECT_FALSE(std::filesystem::exists(folder / "out" / "runs" / "tiny_column" / "tiny" / "yade_seed1"));
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
  EXPECT_FALSE(std::filesystem::exists(output / "runs" / "tiny_column" / "tiny" / "yade_seed1"));
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
