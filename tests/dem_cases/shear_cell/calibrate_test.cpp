// The calibration from synthetic records, whose law is known.
#include "dem_cases/shear_cell/calibrate.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "dem_cases/calibration.h"
#include "tests/dem_cases/shear_cell/shear_cell_files.h"

namespace talus::dem {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double mu_1 = 0.38, mu_2 = 0.7, I_0 = 0.2, phi_max = 0.6, phi_slope = 0.25;
constexpr double degree = std::numbers::pi / 180.0;

json record(const std::string& point, const std::string& code, int seed, const json& observables) {
  return {{"point", point}, {"code", code}, {"seed", seed}, {"version", "1.0"}, {"observables", observables}};
}

class Calibrate : public ::testing::Test {
 protected:
  Calibrate() : cell_(read_shear_cell(shear_cell_file)) {
    for (const ShearMaterial& material : cell_.materials) {
      add_law(material, cell_.biaxial.points, "sin_friction_angle");
      add_law(material, cell_.simple_shear.points, "friction_coefficient");
      json observables = records_.front()["observables"];  // of the slowest biaxial point
      observables["friction_angle_deg"] = 23.4;
      records_.push_back(record(point_name(material, cell_.biaxial.points.front()), "yade", 1, observables));
    }
  }

  /// Three seeds for each point. They scatter about the law and cancel in the mean; walls slip, so that I is not the
  /// wanted one.
  template <class Point>
  void add_law(const ShearMaterial& material, const std::vector<Point>& points, const std::string& friction) {
    for (const Point& point : points) {
      for (const int seed : {1, 2, 3}) {
        const double I = 0.9 * point.inertial_number, offset = 0.002 * (seed - 2);
        records_.push_back(record(point_name(material, point), "liggghts", seed,
                                  {{"inertial_number", I},
                                   {friction, mu_1 + (mu_2 - mu_1) / (1 + I_0 / I) + offset},
                                   {friction + "_error", 0.001},
                                   {"friction_angle_deg", 23.0 + 0.3 * (seed - 2)},
                                   {"friction_angle_deg_error", 0.1},
                                   {"volume_fraction", phi_max - phi_slope * I + offset},
                                   {"volume_fraction_error", 0.001}}));
      }
    }
  }

  MaterialConstants constants() {
    const auto file = folder_.path() / "calibration.toml";
    write_file_atomically(file, calibrate(cell_, records_));
    return read_calibration(file, "rolling_friction_0_2");
  }

  TestFolder folder_;
  ShearCell cell_;
  std::vector<json> records_;
};

TEST_F(Calibrate, FindsTheLawAndReadsItBack) {
  const MaterialConstants found = constants();
  ASSERT_TRUE(found.friction_law);
  EXPECT_NEAR(found.friction_law->mu_1, mu_1, 1e-3);
  EXPECT_NEAR(found.friction_law->mu_2, mu_2, 5e-3);
  EXPECT_NEAR(found.friction_law->I_0, I_0, 5e-3);
  EXPECT_NEAR(found.max_volume_fraction, phi_max, 1e-4);
  EXPECT_EQ(found.status, "calibrated");
  EXPECT_THAT(found.source,
              AllOf(HasSubstr("liggghts 1.0 (3 runs), yade 1.0 (1 run)"), HasSubstr("2178 grains"),
                    HasSubstr("simple shear at 1000 Pa and 4 rates, liggghts 1.0 (12 runs)")));
  EXPECT_GT(found.friction_law->mu_1_uncertainty, 1e-4);
  EXPECT_LT(found.friction_law->mu_1_uncertainty, 3e-3);
}

// Codes at 23.0 and 23.4: half their range is 0.2 degrees, and seeds add 0.3 / sqrt(3) of one and 0.1 of the other.
TEST_F(Calibrate, AngleIsOfBothCodesAndItsUncertaintyToo) {
  const MaterialConstants found = constants();
  EXPECT_NEAR(found.friction_angle / degree, 23.2, 1e-3);
  EXPECT_NEAR(found.friction_angle_uncertainty / degree,
              std::hypot(0.2, 0.5 * std::hypot(0.3 / std::sqrt(3.0), 0.1)), 0.01);
}

// Three seeds that agree by chance are no surer than each of them is.
TEST_F(Calibrate, ScatterThatIsSmallByChanceIsNotBelieved) {
  for (json& stored : records_) {
    if (stored["observables"].contains("friction_angle_deg"))
      stored["observables"]["friction_angle_deg"] = 23.0;
  }
  EXPECT_NEAR(constants().friction_angle_uncertainty / degree, 0.5 * std::hypot(0.1 / std::sqrt(3.0), 0.1),
              1e-3);
}

// One point off the law by thirty times its error: the constants must not look as sure as before.
TEST_F(Calibrate, LawThatMissesItsPointsIsLessSure) {
  const double before = constants().friction_law->mu_1_uncertainty;
  for (json& stored : records_) {
    if (stored["point"] != point_name(cell_.materials[1], cell_.biaxial.points[1])) continue;
    json& friction = stored["observables"]["sin_friction_angle"];
    friction = friction.get<double>() + 0.03;
  }
  EXPECT_GT(constants().friction_law->mu_1_uncertainty, 3.0 * before);
}

TEST_F(Calibrate, RecordsOfOtherCasesAreLeftOut) {
  const std::string text = calibrate(cell_, records_);
  records_.push_back(record("a_2", "liggghts", 1, {{"x90", 1.5}}));
  EXPECT_EQ(calibrate(cell_, records_), text);
}

TEST_F(Calibrate, MissingPointIsNamed) {
  const auto& first = cell_.simple_shear.points.front();
  std::erase_if(records_,
                [&](const json& stored) { return stored["point"] == point_name(cell_.materials[1], first); });
  EXPECT_THAT(input_error([&] { calibrate(cell_, records_); }),
              AllOf(HasSubstr("simple_shear-rolling_friction_0_2-0.03"), HasSubstr("no stored run")));
}

TEST_F(Calibrate, DamagedRecordIsToldByKey) {
  records_.front()["observables"].erase("volume_fraction");
  EXPECT_THAT(input_error([&] { calibrate(cell_, records_); }), HasSubstr("'volume_fraction'"));
  records_.front().erase("point");
  EXPECT_THAT(input_error([&] { calibrate(cell_, records_); }), HasSubstr("'point'"));
}

TEST_F(Calibrate, FrictionThatFallsWithTheRateIsNoLaw) {
  for (json& stored : records_) {
    json& observables = stored["observables"];
    for (const char* name : {"friction_coefficient", "sin_friction_angle"}) {
      if (observables.contains(name)) observables[name] = 0.5 - observables["inertial_number"].get<double>();
    }
  }
  EXPECT_THAT(input_error([&] { calibrate(cell_, records_); }), HasSubstr("rolling_friction_0"));
}

}  // namespace
}  // namespace talus::dem
