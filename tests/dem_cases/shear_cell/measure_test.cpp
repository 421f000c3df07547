// Measures of samples whose answers are known.
#include "dem_cases/shear_cell/measure.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "dem_cases/shear_cell/schedule.h"
#include "tests/dem_cases/shear_cell/shear_cell_files.h"

namespace talus::dem {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int grains = 300;

class ShearMeasure : public ::testing::Test {
 protected:
  ShearMeasure()
      : cell_(read_shear_cell(tiny_shear_cell_file)),
        point_(cell_.simple_shear.points.at(0)),
        biaxial_point_(cell_.biaxial.points.at(0)) {}

  /// Writes columns, then a line of `line(strain of the walls)` after each sample's steps, up to `until` of the run.
  void write(std::string_view columns, std::int64_t step_count, double rate,
             const std::function<std::string(double)>& line, double until = 1.0) {
    std::string text = fmt::format("{}\n", columns);
    const int interval = cell_.protocol.steps_per_sample;
    for (std::int64_t step = interval; step <= std::llround(until * static_cast<double>(step_count));
         step += interval) {
      text += fmt::format("{} {}\n", step, line(static_cast<double>(step) * cell_.protocol.time_step * rate));
    }
    write_file_atomically(folder_.path() / samples_file, text);
  }

  /// The transient has another friction, which must not count; so do the oscillations, which average out.
  void write_simple_shear(double normal_stress = 1000.0, double rate_share = 0.9, int grain_count = grains,
                          double until = 1.0) {
    const double rate = wall_shear_rate(cell_, point_);
    write(
        simple_shear_columns, step_count(cell_, point_), rate,
        [&](double strain) {
          const double wave = std::sin(40.0 * M_PI * strain);
          const double friction = strain < point_.transient_strain ? 0.9 : 0.4;
          return fmt::format("{} {} {} {} 1e-3 {}", normal_stress * (1.0 + 0.1 * wave),
                             friction * normal_stress * (1.0 + 0.1 * wave), 0.58 + 0.01 * wave,
                             rate_share * rate, grain_count);
        },
        until);
  }

  void write_biaxial(double lateral_stress = 1000.0, int grain_count = grains) {
    write(biaxial_columns, step_count(cell_, biaxial_point_), axial_rate(cell_, biaxial_point_),
          [&](double strain) {
            const double axial_stress = (strain < biaxial_point_.averaged_from ? 5.0 : 3.0) * lateral_stress;
            return fmt::format("{} 1800 {} 0.59 {} 1e-6 {}", lateral_stress, axial_stress, strain,
                               grain_count);
          });
  }

  nlohmann::json simple_shear() { return measure_simple_shear(cell_, point_, grains, folder_.path()); }
  nlohmann::json biaxial() { return measure_biaxial(cell_, biaxial_point_, grains, folder_.path()); }
  std::string simple_shear_error() {
    return input_error([&] { simple_shear(); });
  }

  TestFolder folder_;
  ShearCell cell_;
  SimpleShearPoint point_;
  BiaxialPoint biaxial_point_;
};

TEST_F(ShearMeasure, SimpleShearIsAveragedAfterTheTransient) {
  write_simple_shear();
  const auto observables = simple_shear()["observables"];
  EXPECT_NEAR(observables["friction_coefficient"], 0.4, 1e-4);
  EXPECT_NEAR(observables["volume_fraction"], 0.58, 1e-4);
  EXPECT_NEAR(observables["inertial_number"], 0.09, 1e-4);
  EXPECT_NEAR(observables["shear_strain"], 0.9 * point_.strain, 0.03);  // two samples: whole ones count
  // Shear and normal stress go up and down together: their ratio is sure although neither is.
  EXPECT_LT(observables["friction_coefficient_error"], 1e-3);
  EXPECT_GT(observables["volume_fraction_error"], 0.0);
}

TEST_F(ShearMeasure, CurvesAreSmallAndShowTheTransient) {
  write_simple_shear();
  const auto curves = simple_shear()["curves"];
  EXPECT_LE(curves["friction_coefficient"].size(), 100U);
  EXPECT_GE(curves["friction_coefficient"].size(), 40U);
  EXPECT_EQ(curves["shear_strain"].size(), curves["friction_coefficient"].size());
  EXPECT_NEAR(curves["friction_coefficient"].front(), 0.9, 1e-3);
  EXPECT_NEAR(curves["friction_coefficient"].back(), 0.4, 1e-3);
  EXPECT_NEAR(curves["shear_strain"].back(), 0.9 * (point_.transient_strain + point_.strain), 0.1);
}

// Axial stress three times the lateral one: (3 - 1) / (3 + 1) = sin 30 degrees.
TEST_F(ShearMeasure, BiaxialGivesTheFrictionAngle) {
  write_biaxial();
  const auto measured = biaxial();
  EXPECT_NEAR(measured["observables"]["friction_angle_deg"], 30.0, 1e-6);
  EXPECT_NEAR(measured["observables"]["sin_friction_angle"], 0.5, 1e-9);
  EXPECT_NEAR(measured["observables"]["volume_fraction"], 0.59, 1e-9);
  EXPECT_NEAR(measured["observables"]["intermediate_stress_ratio"], 0.9, 1e-9);
  // Of the mean stress, 2 kPa, not of the lateral one.
  EXPECT_NEAR(measured["observables"]["inertial_number"], biaxial_point_.inertial_number / std::sqrt(2.0),
              1e-5);
  EXPECT_NEAR(measured["curves"]["sin_friction_angle"].front(), 2.0 / 3.0, 1e-6);
}

TEST_F(ShearMeasure, RefusesWhatTheCaseDidNotAskFor) {
  write_simple_shear(1300.0);
  EXPECT_THAT(simple_shear_error(), AllOf(HasSubstr("normal stress"), HasSubstr("1300"), HasSubstr("20 %")));
  write_simple_shear(1000.0, 0.4);
  EXPECT_THAT(simple_shear_error(), AllOf(HasSubstr("inertial number"), HasSubstr("50 %")));
  write_biaxial(700.0);
  EXPECT_THAT(input_error([&] { biaxial(); }), AllOf(HasSubstr("lateral stress"), HasSubstr("700")));
  write_simple_shear();
  cell_.protocol.least_strain = 5.0;
  EXPECT_THAT(simple_shear_error(), AllOf(HasSubstr("shear strain"), HasSubstr("at least 5")));
}

TEST_F(ShearMeasure, RefusesLostGrainsAndDamage) {
  write_simple_shear(1000.0, 0.9, grains - 1);
  EXPECT_THAT(simple_shear_error(), AllOf(HasSubstr("299"), HasSubstr("lost")));
  write_biaxial(1000.0, grains + 1);
  EXPECT_THAT(input_error([&] { biaxial(); }), HasSubstr("301"));
  write_simple_shear(1000.0, 0.9, grains, 0.5);
  EXPECT_THAT(simple_shear_error(), HasSubstr("did not finish"));
  const auto file = folder_.path() / samples_file;
  const std::string text = read_file(file);
  write_file_atomically(file, text.substr(0, text.size() - 10));
  EXPECT_THAT(simple_shear_error(), HasSubstr("did not finish"));
  write_simple_shear();
  write_file_atomically(file, read_file(file).replace(read_file(file).rfind("1e-3"), 4, "-nan"));
  EXPECT_THAT(simple_shear_error(), AllOf(HasSubstr("-nan"), HasSubstr("not a finite number")));
  write_simple_shear();
  write_file_atomically(file, replaced(read_file(file), "\n40 ", "\n41 "));
  EXPECT_THAT(simple_shear_error(), HasSubstr("step 41 instead of 40"));
  std::filesystem::remove(file);
  EXPECT_THAT(simple_shear_error(), HasSubstr("samples.txt"));
}

TEST_F(ShearMeasure, ProgressIsTheShareOfTheSteps) {
  EXPECT_EQ(samples_progress(folder_.path(), 100.0), 0.0);
  const auto steps = static_cast<double>(step_count(cell_, point_));
  write_simple_shear(1000.0, 0.9, grains, 0.5);
  EXPECT_NEAR(samples_progress(folder_.path(), steps), 0.5, 0.02);
  write_simple_shear();
  EXPECT_EQ(samples_progress(folder_.path(), steps), 1.0);
}

}  // namespace
}  // namespace talus::dem
