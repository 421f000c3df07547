// Runs the real LIGGGHTS and YADE on a shear cell of a few hundred grains.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "continuum/files/process.h"
#include "dem_cases/shear_cell/measure.h"
#include "tests/dem_cases/shear_cell/shear_cell_files.h"

namespace talus::dem {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// The planned run of the tiny cell's second material, which has rolling friction.
PlannedRun planned(const std::string& test, const std::string& code) {
  for (const PlannedRun& run : shear_cell_runs(read_shear_cell(tiny_shear_cell_file))) {
    if (run.point_name.starts_with(test + "-rolling_friction_0_2") && run.code == code) return run;
  }
  throw std::logic_error("there is no such run");
}

ProcessResult run_in(const PlannedRun& run, const std::filesystem::path& folder,
                     std::function<bool()> stop = {}) {
  return run_process({.command = run.command,
                      .folder = folder,
                      .log = run.log_file,
                      .environment = {},
                      .time_limit = std::chrono::seconds(120),
                      .stop = std::move(stop)});
}

nlohmann::json measured(const PlannedRun& run, const std::filesystem::path& folder) {
  run.write_input(folder);
  EXPECT_EQ(run.progress(folder), 0.0);
  EXPECT_EQ(run_in(run, folder).exit_code, 0) << run.failure_text(folder);
  EXPECT_EQ(run.failure_text(folder), "");
  EXPECT_EQ(run.progress(folder), 1.0);
  return run.measure(folder)["observables"];
}

// 250 grains between walls: wide bounds about the 0.51 and 0.55 of the full size. Grains without sliding friction would
// have 0.1, and a piston that lost its load no stress.
TEST(SimpleShearRun, HasTheFrictionOfGrainsAndRepeatsToTheByte) {
  const TestFolder folder;
  const PlannedRun run = planned("simple_shear", "liggghts");
  const auto observables = measured(run, folder.path());
  EXPECT_NEAR(observables["friction_coefficient"], 0.51, 0.1);
  EXPECT_NEAR(observables["volume_fraction"], 0.55, 0.03);
  EXPECT_NEAR(observables["normal_stress"], 1000.0, 100.0);
  const std::string once = read_file(folder.path() / samples_file);
  measured(run, folder.path());
  EXPECT_EQ(once, read_file(folder.path() / samples_file));
}

// Two hundred grains of one start, between an axial strain of 0.1 and 0.2: no critical state yet.
TEST(BiaxialRun, IsTheSameToBothCodes) {
  const TestFolder folder;
  const auto from_liggghts = measured(planned("biaxial", "liggghts"), folder.path() / "liggghts");
  const auto from_yade = measured(planned("biaxial", "yade"), folder.path() / "yade");
  EXPECT_NEAR(from_liggghts["friction_angle_deg"], from_yade["friction_angle_deg"], 3.0);
  EXPECT_NEAR(from_liggghts["volume_fraction"], from_yade["volume_fraction"], 0.015);
  EXPECT_NEAR(from_liggghts["friction_angle_deg"], 36.0, 6.0);  // near the peak of so small a sample
}

TEST(BiaxialRun, RepeatsToTheByteAndInterruptedIsNotTakenForWhole) {
  const TestFolder folder;
  const PlannedRun run = planned("biaxial", "liggghts");
  measured(run, folder.path());
  const std::string once = read_file(folder.path() / samples_file);
  run.write_input(folder.path());
  const auto result = run_in(run, folder.path(), [&] { return run.progress(folder.path()) > 0.2; });
  ASSERT_TRUE(result.interrupted);
  EXPECT_THAT(input_error([&] { run.measure(folder.path()); }), HasSubstr("did not finish"));
  measured(run, folder.path());
  EXPECT_EQ(once, read_file(folder.path() / samples_file));
}

TEST(BiaxialRun, BrokenDeckSaysWhy) {
  const TestFolder folder;
  const PlannedRun run = planned("biaxial", "liggghts");
  run.write_input(folder.path());
  const auto deck = folder.path() / "in.liggghts";
  write_file_atomically(deck, replaced(read_file(deck), "atom_modify map array", "atom_mollify map array"));
  EXPECT_NE(run_in(run, folder.path()).exit_code, 0);
  EXPECT_THAT(run.failure_text(folder.path()), AllOf(HasSubstr("ERROR"), HasSubstr("atom_mollify")));
}

}  // namespace
}  // namespace talus::dem
