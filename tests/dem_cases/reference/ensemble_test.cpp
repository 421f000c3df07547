// The reference generator with the real LIGGGHTS and YADE: one small case of each kind, and what can go wrong.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "analysis/coarse_graining/coarse_graining.h"
#include "dem_cases/contact_dump.h"
#include "dem_cases/grain_dump.h"
#include "dem_cases/reference/make_run.h"
#include "dem_cases/reference/plan.h"
#include "dem_cases/reference/store.h"
#include "tests/dem_cases/case_files.h"
#include "tests/program.h"

namespace talus::dem {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::filesystem::path data = TALUS_SOURCE_DIR "/tests/dem_cases/data";

PlannedRun planned(const std::filesystem::path& file, const std::string& code) {
  for (PlannedRun& run : planned_runs_of_file(file)) {
    if (run.code == code) return run;
  }
  throw std::runtime_error("no such run");
}

nlohmann::json made(const PlannedRun& run, const std::filesystem::path& folder) {
  return make_run(run, folder, prepare_run(run, folder), [] { return false; });
}

std::string failure(const PlannedRun& run, const std::filesystem::path& folder,
                    const std::function<bool()>& stop) {
  const auto hash = prepare_run(run, folder);
  try {
    make_run(run, folder, hash, stop);
  } catch (const RunFailed& error) {
    return error.what();
  }
  ADD_FAILURE() << "the run did not fail";
  return {};
}

struct Kind {
  const char* name;
  const char* observable;
  double low, high;  // what such a small case can give with rolling friction 0.2, either code
};

void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

class EachKind : public ::testing::TestWithParam<std::tuple<Kind, const char*>> {};

TEST_P(EachKind, RunsAndIsMeasured) {
  const auto& [kind, code] = GetParam();
  const TestFolder folder;
  const auto record = made(planned(data / fmt::format("tiny_{}.toml", kind.name), code), folder.path());
  const double value = record.at("observables").at(kind.observable);
  EXPECT_GT(value, kind.low);
  EXPECT_LT(value, kind.high);
  EXPECT_EQ(record.at("code"), code);
  EXPECT_GT(record.at("cpu_s").get<double>(), 0.01);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "snapshots.h5"));
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, EachKind,
    ::testing::Combine(::testing::Values(Kind{"cylinder_collapse", "r90", 1.3, 2.0},
                                         Kind{"heap", "repose_angle", 15.0, 40.0},
                                         Kind{"slot", "discharge_rate", 0.025, 0.06},
                                         Kind{"hourglass", "discharge_rate", 0.04, 0.14},
                                         Kind{"ledge", "repose_angle", 25.0, 45.0},
                                         // A third to two thirds of the sphere's diameter.
                                         Kind{"impact", "penetration_depth", 0.004, 0.008}),
                       ::testing::Values("liggghts", "yade")),
    [](const auto& instance) {
      return fmt::format("{}_{}", std::get<0>(instance.param).name, std::get<1>(instance.param));
    });

class EachCode : public ::testing::TestWithParam<const char*> {};

// At rest the vertical stress over the floor carries the weight: both codes' contacts have the sign and the unit that
// coarse graining takes.
TEST_P(EachCode, StressOfTheSettledColumnCarriesItsWeight) {
  const TestFolder folder;
  Case column = read_case(tiny_column_file);
  column.reference_seeds = {{GetParam(), {1}}};
  PlannedRun run = planned_runs(column).front();
  analysis::CoarseFields fields;
  analysis::CoarseGrid grid;
  double weight = 0.0;
  run.measure = [&](const auto& where) {
    const Packing packing = make_packing(column, 1);
    const auto release = read_grain_dump(column, packing, where).front();
    const double d = column.grains.diameter;
    const ColumnGeometry& g = column_geometry(column);
    grid = {.origin = {0.0, 0.0, -0.5 * d},
            .spacing = {g.column_length / 4.0, g.thickness, d},
            .cells = {4, 1, static_cast<int>(std::ceil(packing.top() / d)) + 1},
            .edges = {analysis::Edge::wall, analysis::Edge::periodic, analysis::Edge::wall}};
    const auto contacts = read_contacts(column, packing, where);
    fields = analysis::coarse_grain(release, column.grains.density, contacts.release, grid, analysis::Hat{});
    weight = column.grains.density * release.volumes.sum() * column.protocol.gravity /
             (g.column_length * g.thickness);
    return nlohmann::json{{"observables", {{"weight", weight}}}, {"curves", nlohmann::json::object()}};
  };
  made(run, folder.path());
  // The second layer of cells, whose hat reaches from the floor to 2 d: one d of the column stands below its middle.
  double stress = 0.0, below = 0.0;
  for (int i = 0; i < 4; ++i) {
    stress -= fields.stress(grid.index(i, 0, 1))(2, 2) / 4.0;
    below +=
        (fields.volume_fraction[grid.index(i, 0, 0)] + 0.5 * fields.volume_fraction[grid.index(i, 0, 1)]) /
        4.0;
  }
  const double expected =
      weight - column.grains.density * column.protocol.gravity * column.grains.diameter * below;
  EXPECT_NEAR(stress, expected, 0.05 * weight);
  EXPECT_GT(weight, 100.0);  // Pa: there is something to carry
}

TEST_P(EachCode, KilledHalfWayIsAFailureThatSaysWhere) {
  const TestFolder folder;
  const PlannedRun run = planned(data / "tiny_slot.toml", GetParam());
  const auto message = failure(run, folder.path(), [&] { return run.progress(folder.path()) > 0.3; });
  EXPECT_THAT(message,
              AllOf(HasSubstr(GetParam()), HasSubstr("interrupted"), HasSubstr(folder.path().string())));
}

INSTANTIATE_TEST_SUITE_P(Codes, EachCode, ::testing::Values("liggghts", "yade"),
                         [](const auto& instance) { return instance.param; });

// A file that cannot grow, as on a full disk: whatever the code makes of it, no result comes out.
TEST(Faults, FullDiskGivesNoResult) {
  const TestFolder folder;
  PlannedRun run = planned(data / "tiny_slot.toml", "liggghts");
  // Writes fail, as on a full disk, where without the trap the program would be killed.
  run.command.insert(run.command.begin(), {"/usr/bin/prlimit", "--fsize=200000", "/bin/sh", "-c",
                                           "trap '' XFSZ; exec \"$@\"", "sh"});
  EXPECT_THAT(failure(run, folder.path(), [] { return false; }),
              AnyOf(HasSubstr("did not finish"), HasSubstr("exit code")));
}

TEST(Faults, LeakingWallIsFound) {
  const TestFolder folder;
  PlannedRun run = planned(data / "tiny_slot.toml", "liggghts");
  const auto write = run.write_input;
  run.write_input = [write](const auto& where) {
    write(where);
    const auto deck = where / "in.liggghts";
    std::string text = read_file(deck);
    const auto begin = text.find("fix right_wall");
    text.erase(begin, text.find('\n', begin) + 1 - begin);
    write_file_atomically(deck, text);
  };
  EXPECT_THAT(failure(run, folder.path(), [] { return false; }),
              AnyOf(HasSubstr("leaked through the right wall"), HasSubstr("Lost atoms")));
}

TEST(Faults, ADepositThatStillMovesIsRefused) {
  const TestFolder folder;
  Case cylinder = read_case(data / "tiny_cylinder_collapse.toml");
  cylinder.protocol.run_time = 0.07;
  cylinder.reference_seeds = {{"liggghts", {1}}};
  EXPECT_THAT(failure(planned_runs(cylinder).front(), folder.path(), [] { return false; }),
              HasSubstr("had not come to rest"));
}

TEST(Faults, CrashNamesTheCodesOwnWords) {
  const TestFolder folder;
  PlannedRun run = planned(data / "tiny_slot.toml", "liggghts");
  const auto write = run.write_input;
  run.write_input = [write](const auto& where) {
    write(where);
    write_file_atomically(where / "packing.data", "nothing\n");
  };
  EXPECT_THAT(failure(run, folder.path(), [] { return false; }), HasSubstr("ERROR"));
}

/// The program itself, on one small case with LIGGGHTS.
class Program : public ::testing::Test {
 protected:
  testing::ProgramResult run_cases(const std::string& cases,
                                   const std::vector<std::string>& prefix = {}) const {
    std::vector<std::string> command = prefix;
    command.insert(command.end(),
                   {TALUS_BINARY_DIR "/bin/talus-dem", "--reference", reference().string(), "run", cases,
                    "--code", "liggghts", "--runs", (folder_.path() / "runs").string()});
    return testing::run_program(command);
  }
  std::filesystem::path reference() const { return folder_.path() / "reference"; }
  std::filesystem::path stored() const { return reference() / "tiny_cylinder_collapse/tiny.json"; }
  nlohmann::json stored_run() const { return nlohmann::json::parse(read_file(stored())).at("runs").at(0); }

  const std::string cylinder_ = (data / "tiny_cylinder_collapse.toml").string();
  TestFolder folder_;
};

TEST_F(Program, ARunIsStoredOnceAndRepeatsToTheDigit) {
  ASSERT_EQ(run_cases(cylinder_).exit_code, 0);
  const auto first = stored_run();
  const auto again = run_cases(cylinder_);
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.output, HasSubstr("0 runs to make"));
  std::filesystem::remove(stored());
  ASSERT_EQ(run_cases(cylinder_).exit_code, 0);
  for (const char* same : {"input_hash", "observables", "curves", "final_profile", "grains"})
    EXPECT_EQ(first.at(same), stored_run().at(same)) << same;
}

TEST_F(Program, AChangedInputIsRunAgain) {
  ASSERT_EQ(run_cases(cylinder_).exit_code, 0);
  const auto changed = folder_.path() / "changed.toml";
  write_file_atomically(changed, replaced(read_file(cylinder_), "\nfriction = 0.5", "\nfriction = 0.4"));
  const auto again = run_cases(changed.string());
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_THAT(again.output, HasSubstr("1 runs to make"));
}

TEST_F(Program, AChangedRulerIsMeasuredAgain) {
  ASSERT_EQ(run_cases(cylinder_).exit_code, 0);
  const auto changed = folder_.path() / "changed.toml";
  write_file_atomically(changed,
                        replaced(read_file(cylinder_), "front_depth_m = 0.0015", "front_depth_m = 0.002"));
  EXPECT_THAT(run_cases(changed.string()).output, HasSubstr("1 runs to make"));
}

// The slot runs first, as it takes longer; the program is ended as soon as that is stored.
TEST_F(Program, InterruptedAndRestartedLosesNothing) {
  const std::string slot = (data / "tiny_slot.toml").string();
  const std::vector<std::string> command{TALUS_BINARY_DIR "/bin/talus-dem",
                                         "--reference",
                                         reference().string(),
                                         "run",
                                         cylinder_,
                                         slot,
                                         "--code",
                                         "liggghts",
                                         "--jobs",
                                         "1",
                                         "--runs",
                                         (folder_.path() / "runs").string()};
  const auto slot_stored = [&] { return std::filesystem::exists(reference() / "tiny_slot/tiny.json"); };
  const auto ended = run_process({.command = command,
                                  .folder = folder_.path(),
                                  .log = "log",
                                  .environment = {},
                                  .time_limit = std::chrono::seconds(300),
                                  .stop = slot_stored});
  ASSERT_TRUE(ended.interrupted);
  EXPECT_EQ(ended.exit_code, 130);
  EXPECT_TRUE(slot_stored());
  EXPECT_FALSE(std::filesystem::exists(stored()));
  const auto again = testing::run_program(command);
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_THAT(again.output, HasSubstr("1 runs to make"));
  EXPECT_TRUE(std::filesystem::exists(stored()));
}

TEST_F(Program, OwnCasesDoNotGoIntoTheCommittedEnsemble) {
  const auto result =
      testing::run_program({TALUS_BINARY_DIR "/bin/talus-dem", "run", cylinder_, "--code", "liggghts"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("--reference"));
}

TEST_F(Program, MissingCodeNamesThePackage) {
  const auto result = run_cases(cylinder_, {"/usr/bin/env", "PATH=/nowhere"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("apt-get install liggghts"));
  EXPECT_FALSE(std::filesystem::exists(reference()));
}

TEST_F(Program, UnknownCaseAndImpossibleCaseAreInputErrors) {
  const auto unknown = run_cases("colum_collapse");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.output, HasSubstr("colum_collapse"));
  const auto file = folder_.path() / "impossible.toml";
  write_file_atomically(
      file, replaced(read_file(data / "tiny_slot.toml"), "opening_m = 0.015", "opening_m = 0.05"));
  const auto impossible = run_cases(file.string());
  EXPECT_EQ(impossible.exit_code, 2);
  EXPECT_THAT(impossible.output, AllOf(HasSubstr("impossible.toml"), HasSubstr("width_m")));
  EXPECT_FALSE(std::filesystem::exists(reference()));
}

}  // namespace
}  // namespace talus::dem
