// mu(I): its limits, and that it never falls.
#include "continuum/materials/material.h"

#include <gtest/gtest.h>

namespace talus {
namespace {

const Material sand{"sand", 2500.0, 0.6, 0.4, {0.65, 0.3, 0.001}};

/// The shear rate that gives an inertial number.
double shear_rate_of(double inertial_number, double pressure) {
  return inertial_number * std::sqrt(pressure / sand.grain_density) / sand.rate.grain_diameter;
}

TEST(Material, MaxDensityIsThatOfThePackedGrains) { EXPECT_DOUBLE_EQ(sand.max_density(), 1500.0); }

TEST(Friction, IsTheSlowOneAtRestAndTheFastOneInTheLimit) {
  EXPECT_EQ(friction_at(sand, 0.0, 100.0), 0.4);
  EXPECT_EQ(friction_at(sand, 0.0, 0.0), 0.4);
  EXPECT_NEAR(friction_at(sand, shear_rate_of(1e-9, 100.0), 100.0), 0.4, 1e-8);
  EXPECT_NEAR(friction_at(sand, shear_rate_of(1e9, 100.0), 100.0), 0.65, 1e-8);
  EXPECT_EQ(friction_at(sand, 1e-300, 1e300), 0.4);
}

TEST(Friction, GainsHalfAtI0WhateverThePressure) {
  for (const double pressure : {1e-3, 1.0, 1e5})
    EXPECT_NEAR(friction_at(sand, shear_rate_of(0.3, pressure), pressure), 0.5 * (0.4 + 0.65), 1e-12);
  // I = 3 I_0: three quarters.
  EXPECT_NEAR(friction_at(sand, shear_rate_of(0.9, 50.0), 50.0), 0.4 + 0.75 * 0.25, 1e-12);
}

TEST(Friction, WhereNothingPressesItIsTheFastOne) {
  EXPECT_DOUBLE_EQ(friction_at(sand, 1.0, 0.0), 0.65);
  EXPECT_DOUBLE_EQ(friction_at(sand, 1.0, -1e-9), 0.65);  // round-off of a solve
}

TEST(Friction, WithoutRateDependenceItIsConstant) {
  const Material constant{"sand", 2500.0, 0.6, 0.4};
  for (const double rate : {0.0, 1.0, 1e9}) EXPECT_EQ(friction_at(constant, rate, 10.0), 0.4);
  EXPECT_EQ(friction_at(constant, 1.0, 0.0), 0.4);
}

TEST(Friction, GrowsWithTheShearRateAndFallsWithPressure) {
  for (const double pressure : {0.1, 10.0, 1e4}) {
    for (double rate = 1e-3; rate < 1e5; rate *= 1.5) {
      EXPECT_LT(friction_at(sand, rate, pressure), friction_at(sand, 1.5 * rate, pressure));
      EXPECT_GT(friction_at(sand, rate, pressure), friction_at(sand, rate, 1.5 * pressure));
    }
  }
}

}  // namespace
}  // namespace talus
