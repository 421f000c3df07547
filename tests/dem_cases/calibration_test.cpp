#include "dem_cases/calibration.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "dem_cases/case.h"
#include "tests/dem_cases/case_files.h"

namespace talus::dem {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::filesystem::path calibration_file = TALUS_SOURCE_DIR "/dem_cases/shear_cell/calibration.toml";

TEST(Calibration, HasTheMaterialsOfTheCasesAsMeasuredInTheShearCell) {
  const auto smooth = read_calibration(calibration_file, "rolling_friction_0"),
             rolling = read_calibration(calibration_file, read_case(column_collapse_file).calibration);
  for (const auto& constants : {smooth, rolling}) {
    EXPECT_EQ(constants.status, "calibrated");
    EXPECT_THAT(constants.source, AllOf(HasSubstr("biaxial"), HasSubstr("liggghts 3.8.0")));
    ASSERT_TRUE(constants.friction_law);
    // Two tests, one material: slow shear's ratio of stresses is the sine of the critical-state angle.
    EXPECT_NEAR(constants.friction_law->mu_1 / std::sin(constants.friction_angle), 1.0, 0.05);
  }
  // What dem.md had from a thousand grains, within its 1.5 degrees; rolling friction stiffens and loosens.
  EXPECT_NEAR(smooth.friction_angle * 180.0 / std::numbers::pi, 22.7, 1.5);
  EXPECT_NEAR(rolling.friction_angle * 180.0 / std::numbers::pi, 31.1, 2.0);
  EXPECT_NEAR(smooth.max_volume_fraction, 0.595, 0.01);
  EXPECT_NEAR(rolling.max_volume_fraction, 0.564, 0.01);
}

constexpr std::string_view law =
    "mu_1 = 0.37\nmu_1_uncertainty = 0.003\nmu_2 = 0.6\nmu_2_uncertainty = 0.05\nI_0 = 0.3\nI_0_uncertainty "
    "= 0.1\n";

/// A calibration of one material with `lines` added to what every material has.
std::filesystem::path with_lines(const TestFolder& folder, std::string_view lines) {
  const auto file = folder.path() / "calibration.toml";
  write_file_atomically(
      file,
      "schema = 1\n[sand]\nfriction_angle_deg = 22.0\nfriction_angle_uncertainty_deg = 0.2\n"
      "max_volume_fraction = 0.6\nmax_volume_fraction_uncertainty = 0.001\n"
      "status = \"calibrated\"\nsource = \"a test\"\n" +
          std::string(lines));
  return file;
}

TEST(Calibration, HasTheFrictionLawWhereItIsGiven) {
  const TestFolder folder;
  const auto constants = read_calibration(with_lines(folder, law), "sand");
  ASSERT_TRUE(constants.friction_law);
  EXPECT_EQ(constants.friction_law->mu_1, 0.37);
  EXPECT_EQ(constants.friction_law->mu_1_uncertainty, 0.003);
  EXPECT_EQ(constants.friction_law->mu_2, 0.6);
  EXPECT_EQ(constants.friction_law->mu_2_uncertainty, 0.05);
  EXPECT_EQ(constants.friction_law->I_0, 0.3);
  EXPECT_EQ(constants.friction_law->I_0_uncertainty, 0.1);
  EXPECT_FALSE(read_calibration(with_lines(folder, ""), "sand").friction_law);
}

TEST(Calibration, FrictionLawIsWholeAndGrowsWithTheRate) {
  const TestFolder folder;
  const auto error_with = [&](std::string_view from, std::string_view to) {
    const auto file = with_lines(folder, replaced(std::string(law), from, to));
    return input_error([&] { read_calibration(file, "sand"); });
  };
  EXPECT_THAT(error_with("I_0 = 0.3\n", ""), HasSubstr("I_0"));
  EXPECT_THAT(error_with("mu_1 = 0.37\n", ""), HasSubstr("mu_1"));
  EXPECT_THAT(error_with("mu_2 = 0.6\n", "mu_2 = 0.3\n"),
              AllOf(HasSubstr("sand.mu_2"), HasSubstr("above mu_1")));
}

TEST(Calibration, UnknownMaterialNamesThoseThereAre) {
  EXPECT_THAT(input_error([] { read_calibration(calibration_file, "gravel"); }),
              AllOf(HasSubstr("calibration.toml"), HasSubstr("gravel"),
                    HasSubstr("rolling_friction_0, rolling_friction_0_2")));
}

TEST(Calibration, AnotherMaterialsMistakeIsFoundToo) {
  const TestFolder folder;
  const auto file = with_lines(folder, law);
  const std::string gravel = replaced(read_file(file), "[sand]", "[gravel]");
  const std::string two = read_file(file) + gravel.substr(gravel.find("[gravel]"));
  const auto error_with = [&](std::string_view line) {
    std::string wrong = two;
    const std::string right = "friction_angle_deg = 22.0";
    write_file_atomically(file, wrong.replace(wrong.find(right), right.size(), line));
    return input_error([&] { read_calibration(file, "gravel"); });
  };
  EXPECT_THAT(error_with("friction_angle_deg = 0.396"),
              AllOf(HasSubstr("sand.friction_angle_deg"), HasSubstr("0.396"), HasSubstr("between 1 and 60")));
  EXPECT_THAT(error_with("friction_angle_rad = 0.396"), HasSubstr("friction_angle_deg"));
}

}  // namespace
}  // namespace talus::dem
