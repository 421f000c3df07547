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
