// A suite as jobs: locally, and on a real Slurm of one node that the tests start; what was killed half-way is resumed.
#include <gmock/gmock.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "tests/program.h"

namespace talus {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_program;
using testing::TestFolder;
using ::testing::UnorderedElementsAre;

const std::filesystem::path source = TALUS_SOURCE_DIR;
const std::string workflow = (source / "validation/workflow/Snakefile").string();
constexpr double time_limit = 180.0;  // s, of one workflow

const std::vector<std::string> locally{"-j", "2"};
const std::vector<std::string> on_slurm{"--profile",
                                        (source / "validation/workflow/slurm").string(),
                                        "--default-resources",
                                        "slurm_account=tests",
                                        "slurm_partition='all'",
                                        "slurm_extra='--comment sand --requeue'"};

/// A folder to work in, with a stub of talus-validate whose diary tells what the workflow asked of it; or with the program itself.
class Workplace {
 public:
  explicit Workplace(std::filesystem::path program = {}) : program_(std::move(program)) {
    if (program_.empty()) program_ = stub();
    std::filesystem::copy(source / "tests/validation/data/stub_validate", stub());
  }

  std::filesystem::path at(const std::string& name) const { return folder_.path() / name; }
  std::filesystem::path stub() const { return at("stub_validate"); }
  std::filesystem::path record(const std::string& run) const {
    return at("out") / "runs/column/a_1" / run / "record.json";
  }
  void tell(const std::string& file, const std::string& what) const { std::ofstream(at(file)) << what; }
  nlohmann::json results() const { return nlohmann::json::parse(read_file(at("out/results.json"))); }

  std::vector<std::string> command(const std::vector<std::string>& how, const std::string& suite = "stub",
                                   const std::vector<std::string>& more_config = {}) const {
    std::vector<std::string> command{"snakemake", "--snakefile", workflow};
    command.insert(command.end(), how.begin(), how.end());
    for (const std::string& word : {std::string("--config"), "suite=" + suite, std::string("output=out"),
                                    "TALUS_VALIDATE=" + program_.string()})
      command.push_back(word);
    command.insert(command.end(), more_config.begin(), more_config.end());
    return command;
  }
  testing::ProgramResult run(const std::vector<std::string>& how, const std::string& suite = "stub",
                             const std::vector<std::string>& more_config = {}) const {
    return run_program(command(how, suite, more_config), time_limit, folder_.path());
  }

  std::vector<std::string> diary() const {
    std::vector<std::string> lines;
    if (!std::filesystem::exists(at("diary"))) return lines;
    std::istringstream text(read_file(at("diary")));
    for (std::string line; std::getline(text, line);) lines.push_back(line);
    return lines;
  }
  std::vector<std::string> new_in_diary() {
    std::vector<std::string> lines = diary();
    lines.erase(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(read_));
    read_ += lines.size();
    return lines;
  }

  /// Runs the workflow, and calls then(its process id) once, as soon as `when` holds. Returns its exit code; none when that
  /// never held.
  std::optional<int> run_and(const std::vector<std::string>& how, const std::function<bool()>& when,
                             const std::function<void(pid_t)>& then) const {
    bool done = false;
    ProcessRequest request;
    request.command = {"sh", "-c", "echo $$ > pid; exec \"$@\"", "sh"};
    const auto workflow_command = command(how);
    request.command.insert(request.command.end(), workflow_command.begin(), workflow_command.end());
    request.folder = folder_.path();
    request.log = "workflow.log";
    request.time_limit = std::chrono::duration<double>(time_limit);
    request.stop = [&] {
      if (!done && when()) {
        done = true;
        then(std::stoi(read_file(at("pid"))));
      }
      return false;
    };
    const auto result = run_process(request);
    return done ? std::optional(result.exit_code) : std::nullopt;
  }
  /// Kills it and its children outright as soon as `when` holds; false when it never did.
  bool kill_when(const std::vector<std::string>& how, const std::function<bool()>& when) const {
    return run_and(how, when, [](pid_t workflow_process) { kill(-workflow_process, SIGKILL); }).has_value();
  }

 private:
  TestFolder folder_;
  std::filesystem::path program_;
  std::size_t read_ = 0;
};

/// All others done, and the second LIGGGHTS run under way.
std::function<bool()> half_way(const Workplace& place) {
  return [&place] {
    const auto diary = place.diary();
    return std::find(diary.begin(), diary.end(), "run column/a_1/liggghts/2") != diary.end() &&
           std::filesystem::exists(place.record("liggghts_seed1")) &&
           std::filesystem::exists(place.record("continuum_seed1")) &&
           std::filesystem::exists(place.record("continuum_seed2"));
  };
}

const auto all_made =
    UnorderedElementsAre("list", "run column/a_1/continuum/1", "run column/a_1/continuum/2",
                         "run column/a_1/liggghts/1", "run column/a_1/liggghts/2", "run", "check");

TEST(Workflow, MakesEachRunOnceThenGathersAndChecks) {
  Workplace place;
  const auto first = place.run(locally);
  EXPECT_EQ(first.exit_code, 0) << first.output;
  EXPECT_THAT(place.new_in_diary(), all_made);
  EXPECT_EQ(place.results().size(), 4u);
  const auto again = place.run(locally);
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_THAT(place.new_in_diary(), UnorderedElementsAre("list", "run", "check"));
}

TEST(Workflow, FailsWhenTheVerdictIsNotPassAndKeepsTheResults) {
  for (const char* verdict : {"1", "3"}) {
    const Workplace place;
    place.tell("verdict", verdict);
    EXPECT_EQ(place.run(locally).exit_code, 1);
    EXPECT_EQ(place.results().size(), 4u);
  }
}

TEST(Workflow, MakesAgainWhatIsStaleAndNothingElse) {
  Workplace place;
  ASSERT_EQ(place.run(locally).exit_code, 0);
  place.new_in_diary();
  std::ofstream(place.record("liggghts_seed1")) << "\"stale\"";
  const auto again = place.run(locally);
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_THAT(place.new_in_diary(),
              UnorderedElementsAre("list", "run column/a_1/liggghts/1", "run", "check"));
}

TEST(Workflow, ARunThatFailsIsAllThatIsLeftToDo) {
  Workplace place;
  place.tell("fail", "column/a_1/continuum/2");
  const auto failed = place.run({"-j", "2", "--keep-going"});
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(place.at("out/results.json")));
  EXPECT_THAT(read_file(place.at("out/workflow/log/runs.column.a_1.continuum_seed2.log")),
              HasSubstr("a run that fails"));
  EXPECT_THAT(place.new_in_diary(), Not(::testing::Contains("check")));
  place.tell("fail", "");
  const auto again = place.run(locally);
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_THAT(place.new_in_diary(),
              UnorderedElementsAre("list", "run column/a_1/continuum/2", "run", "check"));
}

TEST(Workflow, AsksForTimeAndMemoryByTheList) {
  const Workplace place;
  const auto dry = place.run({"-j", "2", "--dry-run"});
  EXPECT_EQ(dry.exit_code, 0) << dry.output;
  EXPECT_THAT(dry.output, HasSubstr("mem_mb=600"));  // 1.5 x 400
  EXPECT_THAT(dry.output, HasSubstr("runtime=40"));  // 4 x 600 s
  EXPECT_THAT(place.diary(), UnorderedElementsAre("list"));
}

TEST(Workflow, APartOfASuiteIsAskedForByItsTag) {
  const Workplace place;
  const auto part = place.run({"-j", "2"}, "stub", {"tag=quick ones"});
  EXPECT_EQ(part.exit_code, 0) << part.output;
  EXPECT_THAT(place.diary(),
              ::testing::IsSupersetOf({"list --tag quick ones", "run --tag quick ones", "check"}));
}

TEST(Workflow, SaysWhatIsWrongWithItsInput) {
  const Workplace place;
  const auto unknown = place.run(locally, "nonsense");
  EXPECT_NE(unknown.exit_code, 0);
  EXPECT_THAT(unknown.output, HasSubstr("there is no such suite"));
  const auto bare = run_program({"snakemake", "--snakefile", workflow, "-j", "1"}, time_limit, place.at(""));
  EXPECT_NE(bare.exit_code, 0);
  EXPECT_THAT(bare.output, HasSubstr("give --config suite=NAME output=FOLDER"));
}

TEST(Workflow, KilledHalfWayIsResumed) {
  Workplace place;
  place.tell("hold", "column/a_1/liggghts/2");
  ASSERT_TRUE(place.kill_when(locally, half_way(place))) << read_file(place.at("workflow.log"));
  place.tell("hold", "");
  EXPECT_FALSE(std::filesystem::exists(place.record("liggghts_seed2")));
  place.new_in_diary();
  ASSERT_EQ(place.run({"-j", "1", "--unlock"}).exit_code, 0);
  place.new_in_diary();
  const auto resumed = place.run(locally);
  EXPECT_EQ(resumed.exit_code, 0) << resumed.output;
  EXPECT_THAT(place.new_in_diary(),
              UnorderedElementsAre("list", "run column/a_1/liggghts/2", "run", "check"));
}

const std::filesystem::path real_program = std::filesystem::path(TALUS_BINARY_DIR) / "bin/talus-validate";
const std::string tiny_suite = (source / "tests/validation/data/tiny_suite.toml").string();

/// What talus-validate made of the tiny suite, whose verdict is its own affair.
void expect_tiny_results(const Workplace& place, const testing::ProgramResult& result) {
  ASSERT_TRUE(std::filesystem::exists(place.at("out/results.json"))) << result.output;
  EXPECT_TRUE(std::filesystem::exists(place.at("out/report.html")));
  const auto results = place.results();
  ASSERT_EQ(results["points"].size(), 1u);
  std::vector<std::string> runs;
  for (const auto& run : results["points"][0]["runs"]) {
    EXPECT_EQ(run["status"], "ok") << run;
    EXPECT_EQ(run["origin"], "run");
    runs.push_back(run["code"].get<std::string>() + " " + std::to_string(run["seed"].get<int>()));
  }
  EXPECT_THAT(
      runs, UnorderedElementsAre("continuum 1", "continuum 2", "continuum_coarse 1",
                                 "continuum_short_steps 1", "liggghts 1", "liggghts 2", "yade 1", "yade 2"));
  const bool passes = results["verdict"] == "PASS" && results["drift"]["verdict"] == "PASS";
  EXPECT_EQ(result.exit_code, passes ? 0 : 1) << result.output;
}

TEST(Workflow, RunsASuiteOfTheProgramItself) {
  const Workplace place(real_program);
  expect_tiny_results(place, place.run(locally, tiny_suite));
  const auto again = place.run({"-j", "2", "--dry-run"}, tiny_suite);
  EXPECT_THAT(again.output, Not(HasSubstr("rule run:"))) << again.output;
}

/// A Slurm of the tests' own. Where it cannot start they fail.
class Slurm : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TestFolder>();
    start_ = run_program({node, "start", folder_->path().string()}, 120.0);
    setenv("SLURM_CONF", (folder_->path() / "slurm.conf").c_str(), 1);
    setenv("USER", "root", 1);  // whose account Snakemake asks for; not set in containers
  }
  static void TearDownTestSuite() {
    const auto stop = run_program({node, "stop", folder_->path().string()}, 60.0);
    EXPECT_EQ(stop.exit_code, 0) << stop.output;
    folder_.reset();
    unsetenv("SLURM_CONF");
  }
  void SetUp() override { ASSERT_EQ(start_.exit_code, 0) << start_.output; }

  static std::string queue() { return run_program({"squeue", "--noheader"}, 30.0).output; }

  static inline const std::string node = (source / "tests/validation/slurm_node").string();
  static inline std::unique_ptr<TestFolder> folder_;
  static inline testing::ProgramResult start_;
};

TEST_F(Slurm, RunsTheWorkflowAsJobs) {
  Workplace place;
  const auto result = place.run(on_slurm);
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(place.new_in_diary(), all_made);
  EXPECT_EQ(place.results().size(), 4u);
  const auto accounted = run_program(
      {"sacct", "--allocations", "--noheader", "--parsable2", "--format=State,Timelimit,ReqMem,Partition"});
  const std::string job = "COMPLETED|00:40:00|600M|all\n";
  EXPECT_EQ(accounted.output, job + job + job + job);
}

TEST_F(Slurm, RunsASuiteOfTheProgramItself) {
  const Workplace place(real_program);
  expect_tiny_results(place, place.run(on_slurm, tiny_suite));
}

TEST_F(Slurm, KilledHalfWayIsResumed) {
  Workplace place;
  place.tell("hold", "column/a_1/liggghts/2");
  ASSERT_TRUE(place.kill_when(on_slurm, half_way(place))) << read_file(place.at("workflow.log"));
  EXPECT_THAT(queue(), HasSubstr(" R "));  // the job outlives the workflow
  ASSERT_EQ(run_program({"scancel", "--user=root"}, 30.0).exit_code, 0);
  for (int i = 0; i < 100 && !queue().empty(); ++i) usleep(200'000);
  ASSERT_EQ(queue(), "");
  place.tell("hold", "");
  EXPECT_FALSE(std::filesystem::exists(place.record("liggghts_seed2")));
  ASSERT_EQ(place.run({"-j", "1", "--unlock"}).exit_code, 0);
  place.new_in_diary();
  const auto resumed = place.run(on_slurm);
  EXPECT_EQ(resumed.exit_code, 0) << resumed.output;
  EXPECT_THAT(place.new_in_diary(),
              UnorderedElementsAre("list", "run column/a_1/liggghts/2", "run", "check"));
}

TEST_F(Slurm, AJobThatOutlivesItsWorkflowIsWaitedForNotDoubled) {
  Workplace place;
  place.tell("hold", "column/a_1/liggghts/2");
  ASSERT_TRUE(place.kill_when(on_slurm, half_way(place))) << read_file(place.at("workflow.log"));
  ASSERT_EQ(place.run({"-j", "1", "--unlock"}).exit_code, 0);
  place.new_in_diary();
  // Slurm's log of a job says so when its run begins.
  const auto fifth_begun = [&] {
    int begun = 0;
    for (const auto& log : std::filesystem::directory_iterator(place.at(".snakemake/slurm_logs/rule_run")))
      begun += read_file(log.path()).find("rule run:") != std::string::npos;
    return begun == 5;
  };
  const auto exit_code = place.run_and(on_slurm, fifth_begun, [&](pid_t) {
    sleep(2);  // time enough for a program that waits for nothing
    place.tell("hold", "");
  });
  EXPECT_EQ(exit_code, 0) << read_file(place.at("workflow.log"));
  EXPECT_THAT(place.new_in_diary(), UnorderedElementsAre("list", "run", "check"));
}

}  // namespace
}  // namespace talus
