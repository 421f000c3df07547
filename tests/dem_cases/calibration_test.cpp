#include "dem_cases/calibration.h"

#include <gmock/gmock.h>

#include <numbers>

#include "dem_cases/case.h"
#include "tests/dem_cases/case_files.h"

namespace talus::dem {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::filesystem::path calibration_file = TALUS_SOURCE_DIR "/dem_cases/shear_cell/calibration.toml";

TEST(Calibration, HasTheMaterialOfTheColumnCollapse) {
  const auto constants = read_calibration(calibration_file, read_case(column_collapse_file).calibration);
  EXPECT_NEAR(constants.friction_angle, 31.1 * std::numbers::pi / 180, 1e-12);
  EXPECT_NEAR(constants.friction_angle_uncertainty, 1.5 * std::numbers::pi / 180, 1e-12);
  EXPECT_DOUBLE_EQ(constants.max_volume_fraction, 0.564);
  EXPECT_EQ(constants.status, "provisional");
  EXPECT_FALSE(constants.source.empty());
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
  const auto file = folder.path() / "calibration.toml";
  const auto good = read_file(calibration_file);
  write_file_atomically(file, replaced(good, "friction_angle_deg = 22.7", "friction_angle_deg = 0.396"));
  EXPECT_THAT(input_error([&] { read_calibration(file, "rolling_friction_0_2"); }),
              AllOf(HasSubstr("rolling_friction_0.friction_angle_deg"), HasSubstr("0.396"),
                    HasSubstr("between 1 and 60")));
  write_file_atomically(file, replaced(good, "friction_angle_deg = 22.7", "friction_angle_rad = 0.396"));
  EXPECT_THAT(input_error([&] { read_calibration(file, "rolling_friction_0_2"); }),
              HasSubstr("friction_angle_deg"));
}

}  // namespace
}  // namespace talus::dem
