// The program `talus` as a user meets it: runs, help, and errors with their exit codes.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "analysis/snapshot.h"
#include "continuum/files/atomic_file.h"
#include "continuum/io/budget.h"
#include "continuum/qp/problem_file.h"
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
  for (const char* key : {"version", "git_hash", "git_dirty", "compiler", "compiler_flags", "threads", "cpu",
                          "host", "libraries", "input_hash", "command_line", "solver"})
    EXPECT_TRUE(run["provenance"].contains(key)) << key;
  EXPECT_THAT(read_file(folder / "out" / "snapshots.h5"), HasSubstr(run["provenance"].dump()));
  EXPECT_GT(run["budget"]["friction_iterations"], 0);
}

TEST(TalusProgram, TellsMeshesByWhatIsInThem) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  std::ofstream(folder / "scene.toml")
      << small_scene("0.001") << "[[wall]]\nrough = true\nshape = { kind = 'mesh', file = 'wedge.obj' }\n";
  const auto hashes = [&](const std::string& height) {
    std::ofstream(folder / "wedge.obj")
        << "v 0.1 -1 -1\nv 0.2 -1 -1\nv 0.15 -1 " << height << "\nv 0.1 1 -1\nv 0.2 1 -1\nv 0.15 1 " << height
        << "\nf 1 2 3\nf 4 6 5\nf 1 4 5 2\nf 2 5 6 3\nf 3 6 4 1\n";
    const auto result =
        run_program({"talus", "run", (folder / "scene.toml").string(), "-o", (folder / "out").string()});
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return nlohmann::json::parse(read_file(folder / "out" / "run.json"))["provenance"]["mesh_hashes"];
  };
  const auto low = hashes("0.05");
  EXPECT_EQ(low.size(), 1u);
  EXPECT_EQ(low, hashes("0.05"));
  EXPECT_NE(low, hashes("0.06"));
}

TEST(TalusProgram, ARefusedSceneLeavesEarlierResultsAlone) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  const auto run_of = [&](const std::string& name, const std::string& scene) {
    std::ofstream(folder / name) << scene;
    return run_program({"talus", "run", (folder / name).string(), "-o", (folder / "out").string()});
  };
  ASSERT_EQ(run_of("scene.toml", small_scene("0.01")).exit_code, 0);
  const std::string sand =
      "[[sand]]\nmaterial = 'sand'\nshape = { kind = 'sphere', centre_m = [0.03, 0.005, 0.03], "
      "radius_m = 0.005 }\n";
  const auto refused = run_of("scene.toml", small_scene("0.01") + sand);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, HasSubstr("overlap"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out" / "run.json"));
  EXPECT_TRUE(std::filesystem::exists(folder / "out" / "snapshots.h5"));
  const auto named = run_of("s\xff.toml", small_scene("0.01"));  // no UTF-8: as good a name as any
  EXPECT_EQ(named.exit_code, 0) << named.output;
  EXPECT_THAT(read_file(folder / "out" / "run.json"), HasSubstr("s\xef\xbf\xbd.toml"));
}

TEST(TalusProgram, WritesWhatBodiesDoAndTheirSurfaces) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  const auto run_of = [&](const std::string& body) {
    std::ofstream(folder / "scene.toml") << small_scene("0.02") << body;
    const auto result =
        run_program({"talus", "run", (folder / "scene.toml").string(), "-o", (folder / "out").string()});
    EXPECT_EQ(result.exit_code, 0) << result.output;
  };
  run_of(
      "[[body]]\nname = 'ball'\nshape = { kind = 'sphere', centre_m = [0.1, 0.005, 0.06], radius_m = 0.005 "
      "}\n"
      "density_kg_m3 = 7800.0\nfriction_angle_deg = 20.0\n");
  const std::string rows = read_file(folder / "out" / "bodies.csv");
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 4);    // names, the start and two frames
  EXPECT_THAT(rows, HasSubstr("\n0.02,ball,0.1,0.005,0.05"));  // it falls
  EXPECT_GT(std::filesystem::file_size(folder / "out" / "bodies" / "ball.stl"), 84u);
  run_of("");
  EXPECT_FALSE(std::filesystem::exists(folder / "out" / "bodies.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out" / "bodies" / "ball.stl"));
}

TEST(TalusProgram, SaysLoudlyThatItsSolverIsBrokenOnPurpose) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  const auto run_of = [&](const std::string& solver) {
    std::ofstream(folder / "scene.toml") << small_scene("0.02") << solver;
    const auto result =
        run_program({"talus", "run", (folder / "scene.toml").string(), "-o", (folder / "out").string()});
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return std::pair{result.output, nlohmann::json::parse(read_file(folder / "out" / "run.json"))};
  };
  const auto [said, run] = run_of("[solver]\nbroken = \"pressure_pulls\"\n");
  EXPECT_THAT(said, HasSubstr("wrong on purpose"));
  EXPECT_EQ(run["broken"], "pressure_pulls");
  EXPECT_EQ(run["provenance"]["broken"], "pressure_pulls");
  const auto [sound_said, sound_run] = run_of("");
  EXPECT_THAT(sound_said, Not(HasSubstr("wrong on purpose")));
  EXPECT_FALSE(sound_run.contains("broken"));
  EXPECT_FALSE(sound_run["provenance"].contains("broken"));
}

/// The columns of a budget.csv by name.
std::map<std::string, std::vector<double>> read_budget(const std::filesystem::path& file) {
  std::istringstream lines(read_file(file));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line + "\n", Budget::header());
  std::vector<std::string> names;
  std::istringstream header(line);
  for (std::string name; std::getline(header, name, ',');) names.push_back(name);
  std::map<std::string, std::vector<double>> columns;
  while (std::getline(lines, line)) {
    std::istringstream row(line);
    std::size_t column = 0;
    for (std::string value; std::getline(row, value, ','); ++column) {
      std::size_t parsed = 0;
      columns[names.at(column)].push_back(std::stod(value, &parsed));
      EXPECT_EQ(parsed, value.size()) << value;
    }
    EXPECT_EQ(column, names.size()) << line;
  }
  return columns;
}

TEST(TalusProgram, TheBudgetHasARowAStepThatAgreesWithItsSummary) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  std::ofstream(folder / "scene.toml") << small_scene("0.045") << "[solver]\nmax_friction_iterations = 30\n";
  const auto result =
      run_program({"talus", "run", (folder / "scene.toml").string(), "--output", (folder / "out").string()});
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_FALSE(std::filesystem::exists(folder / "out" / "budget.csv.partial"));
  auto columns = read_budget(folder / "out" / "budget.csv");
  const auto budget = nlohmann::json::parse(read_file(folder / "out" / "run.json"))["budget"];
  const auto sum = [&](const char* name) {
    return std::accumulate(columns[name].begin(), columns[name].end(), 0.0);
  };
  const auto& steps = columns["step"];
  EXPECT_EQ(budget["steps"], steps.size());
  for (std::size_t i = 0; i < steps.size(); ++i) EXPECT_EQ(steps[i], static_cast<double>(i + 1));
  for (const char* name : {"friction_iterations", "pressure_iterations", "packing_iterations", "cap_hits",
                           "splits", "merges", "mass_left_kg", "mass_added_kg"})
    EXPECT_EQ(budget[name], sum(name)) << name;
  EXPECT_GT(sum("cap_hits"), 0.0);  // the cap was set low enough for that
  EXPECT_NEAR(sum("dt_s"), 0.045, 1e-12);
  EXPECT_NEAR(columns["time_s"].back(), 0.045, 1e-12);
  EXPECT_TRUE(std::is_sorted(columns["time_s"].begin(), columns["time_s"].end()));
  EXPECT_EQ(budget["shortest_step_s"], *std::min_element(columns["dt_s"].begin(), columns["dt_s"].end()));
  EXPECT_EQ(budget["bulk_volume_m3"], columns["bulk_volume_m3"].back());
}

TEST(TalusProgram, DumpsTheProblemsOfAStepAndTellsOfOneThatNeverCame) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  const auto out = folder / "out";
  std::ofstream(folder / "scene.toml") << small_scene("0.02");
  std::filesystem::create_directories(out / "qp" / "step_000077");  // an earlier run's
  const auto result = run_program({"talus", "run", (folder / "scene.toml").string(), "--output", out.string(),
                                   "--dump-qp", "1", "--dump-qp", "999"});
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("no step 999 to dump: the run took steps 0 to "));
  std::vector<std::string> dumped;
  for (const auto& step : std::filesystem::directory_iterator(out / "qp"))
    dumped.push_back(step.path().filename().string());
  EXPECT_EQ(dumped, std::vector<std::string>{"step_000001"});
  int problems = 0;
  for (const auto& file : std::filesystem::directory_iterator(out / "qp" / "step_000001")) {
    EXPECT_NO_THROW(read_problem(file.path())) << file.path();
    ++problems;
  }
  EXPECT_GE(problems, 4);  // friction and pressure, twice
  EXPECT_EQ(run_program({"talus", "run", (folder / "scene.toml").string(), "--output", out.string(),
                         "--dump-qp", "-1"})
                .exit_code,
            2);
}

TEST(TalusProgram, AGateThatOpensWhenAFrameEndsLeavesNoSliverOfAStep) {
  const TestFolder temporary;
  const auto& folder = temporary.path();
  // 3 * 0.0033 is a little less than 0.0099 in binary.
  std::ofstream(folder / "scene.toml")
      << testing::replaced(small_scene("0.0165"), "frame_interval_s = 0.01", "frame_interval_s = 0.0033")
      << "[[wall]]\nrough = true\nopens_at_s = 0.0099\n"
         "shape = { kind = \"box\", lower_m = [0.05, -1.0, -1.0], upper_m = [0.07, 1.0, 1.0] }\n";
  const auto result =
      run_program({"talus", "run", (folder / "scene.toml").string(), "--output", (folder / "out").string()});
  ASSERT_EQ(result.exit_code, 0) << result.output;
  auto columns = read_budget(folder / "out" / "budget.csv");
  EXPECT_GT(*std::min_element(columns["dt_s"].begin(), columns["dt_s"].end()), 1e-4);
  EXPECT_EQ(std::count(columns["time_s"].begin(), columns["time_s"].end(), 0.0099), 1);
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
  EXPECT_THAT(result.output, HasSubstr("'time.end_s' = -1: must be between 1e-09 and 1000000000"));
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
  for (const char* old : {"snapshots.h5", "run.json", "budget.csv", "bodies.csv"})
    std::ofstream(folder / "out" / old) << "old";
  const auto result = run_program(
      {"talus", "run", (folder / "scene.toml").string(), "--output", (folder / "out").string()}, 2.0);
  EXPECT_TRUE(result.timed_out);
  EXPECT_TRUE(std::filesystem::exists(folder / "out"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out" / "snapshots.h5"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out" / "run.json"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out" / "budget.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out" / "bodies.csv"));
  // What an unfinished run leaves of its budget can be read.
  const std::string start = Budget::header() + "1,";
  EXPECT_EQ(read_file(folder / "out" / "budget.csv.partial").substr(0, start.size()), start);
}

TEST(TalusProgram, SaysWhatItIs) {
  EXPECT_THAT(run_program({"talus", "--version"}).output,
              AllOf(HasSubstr("talus 0.1.0 (git "), HasSubstr("flags: -"), HasSubstr(" eigen 3."),
                    HasSubstr(" ode 0.")));
  const auto solver = run_program({"talus", "--solver"});
  EXPECT_EQ(solver.exit_code, 0);
  EXPECT_THAT(solver.output, ::testing::MatchesRegex("talus 0.1.0 solver [0-9a-f]{16} g\\+\\+ .*\n"));
  EXPECT_THAT(run_program({"talus", "run", "--help"}).output, HasSubstr("--output"));
}

}  // namespace
}  // namespace talus
