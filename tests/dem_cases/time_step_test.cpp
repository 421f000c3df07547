#include "dem_cases/time_step.h"

#include <gmock/gmock.h>

#include "tests/dem_cases/case_files.h"

namespace talus::dem {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// Worked by hand from the formulas for r = 1.275 mm, rho = 2500 kg/m^3, E = 5 MPa, nu = 0.3, v = 1.372 m/s.
TEST(TimeStep, RayleighAndHertzTimesOfTheColumnCollapse) {
  const auto check = check_time_step(read_case(column_collapse_file));
  EXPECT_NEAR(check.rayleigh_time, 1.5605e-4, 2e-7);
  EXPECT_NEAR(check.hertz_time, 3.22e-4, 2e-6);
  EXPECT_NEAR(check.rayleigh_fraction, 3.5e-5 / 1.5605e-4, 5e-4);
}

TEST(TimeStep, ThreeTimesTheStepIsRefused) {
  Case column = read_case(column_collapse_file);
  column.protocol.time_step *= 3.0;
  EXPECT_THAT(input_error([&] { check_time_step(column); }),
              AllOf(HasSubstr("case.toml"), HasSubstr("protocol.time_step_s"), HasSubstr("0.000105"),
                    HasSubstr("Rayleigh"), HasSubstr("use at most")));
}

TEST(TimeStep, ScalesWithTheRootOfTheStiffness) {
  Case column = read_case(column_collapse_file);
  const double soft = check_time_step(column).rayleigh_time;
  column.grains.youngs_modulus *= 100.0;
  column.protocol.time_step /= 10.0;
  EXPECT_NEAR(check_time_step(column).rayleigh_time, soft / 10.0, 1e-12);
}

TEST(TimeStep, ScheduleCoversTheWholeRun) {
  const Case column = read_case(column_collapse_file);
  const auto schedule = step_schedule(column);
  EXPECT_EQ(schedule.settle, 10000);
  EXPECT_EQ(schedule.per_snapshot, 200);
  EXPECT_EQ(schedule.snapshot_count, 100);
  EXPECT_NEAR(static_cast<double>(schedule.run()) * column.protocol.time_step, column.protocol.run_time,
              1e-12);
}

}  // namespace
}  // namespace talus::dem
