// The shear cell's case file, its starts and its input files; no code is run.
#include "dem_cases/shear_cell/shear_cell.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <sstream>

#include "dem_cases/shear_cell/liggghts_deck.h"
#include "dem_cases/shear_cell/schedule.h"
#include "dem_cases/shear_cell/start.h"
#include "dem_cases/shear_cell/yade_input.h"
#include "tests/dem_cases/shear_cell/shear_cell_files.h"

namespace talus::dem {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// The error of the case file with one thing changed.
std::string error_of(std::string_view from, std::string_view to) {
  const TestFolder folder;
  const auto file = folder.path() / "case.toml";
  write_file_atomically(file, replaced(read_file(shear_cell_file), from, to));
  return input_error([&] { read_shear_cell(file); });
}

TEST(ShearCell, IsLargeAndLongEnough) {
  const ShearCell cell = read_shear_cell(shear_cell_file);
  EXPECT_GE(cell.simple_shear.lattice.prod(), 2000);
  EXPECT_GE(cell.biaxial.lattice.prod(), 2000);
  for (const BiaxialPoint& point : cell.biaxial.points) EXPECT_GE(point.axial_strain, 0.6);
  EXPECT_GE(cell.protocol.least_strain, 0.6);
  EXPECT_LE(cell.biaxial.points.front().inertial_number, 1.5e-3);
  EXPECT_GE(cell.simple_shear.points.back().inertial_number, 0.3);
  EXPECT_EQ(cell.simple_shear.liggghts_seeds.size(), 3U);
  EXPECT_EQ(cell.biaxial.liggghts_seeds.size(), 3U);
}

TEST(ShearCell, BadInputIsToldByKey) {
  EXPECT_THAT(error_of("restitution = 0.5", "restitution = 1.5"),
              AllOf(HasSubstr("contact.restitution"), HasSubstr("1.5")));
  EXPECT_THAT(error_of("normal_stress_pa = 1000.0", "normal_stress_pa = 1e4"),
              AllOf(HasSubstr("normal_stress_pa"), HasSubstr("5000")));
  EXPECT_THAT(error_of("least_strain = 0.6", "least_strain = 1.2"), HasSubstr("averaged_from"));
  EXPECT_THAT(error_of("inertial_number = 0.013\n", "inertial_number = 0.001\n"), HasSubstr("slowest"));
  EXPECT_THAT(error_of("servo_gain_per_s", "servo_gain"), HasSubstr("servo_gain_per_s"));
  EXPECT_THAT(error_of("name = \"rolling_friction_0_2\"", "name = \"rolling_friction_0\""),
              HasSubstr("given twice"));
  EXPECT_THAT(error_of("time_step_s = 3.5e-5 ", "time_step_s = 1e-4 "), HasSubstr("Rayleigh"));
  EXPECT_THAT(error_of("kind = \"shear_cell\"", "kind = \"column_collapse\""), HasSubstr("shear_cell"));
}

/// The smallest gap between free spheres and any other, over all periodic images.
double smallest_gap(const ShearStart& start, const Eigen::Array3d& periodic) {
  double smallest = 1.0;
  for (Eigen::Index i = 2 * start.wall_count; i < start.count(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      Eigen::Array3d apart = start.positions.col(i) - start.positions.col(j);
      apart -= periodic * start.size.array() * (apart / start.size.array()).round();
      smallest = std::min(smallest, apart.matrix().norm() - start.radii[i] - start.radii[j]);
    }
  }
  return smallest;
}

TEST(ShearStart, NoFreeGrainTouchesAnother) {
  const ShearCell cell = read_shear_cell(tiny_shear_cell_file);
  EXPECT_GT(smallest_gap(make_periodic_start(cell, 1), {1, 1, 1}), 0.0);
  EXPECT_GT(smallest_gap(make_walled_start(cell, 1), {1, 1, 0}), 0.0);
}

TEST(ShearStart, SeedDecidesAll) {
  const ShearCell cell = read_shear_cell(tiny_shear_cell_file);
  EXPECT_EQ(make_walled_start(cell, 1).positions, make_walled_start(cell, 1).positions);
  EXPECT_NE(make_walled_start(cell, 1).positions, make_walled_start(cell, 2).positions);
  EXPECT_NE(make_periodic_start(cell, 1).radii, make_periodic_start(cell, 2).radii);
}

TEST(ShearStart, SolidVolumeIsOfTheFreeGrains) {
  const ShearCell cell = read_shear_cell(tiny_shear_cell_file);
  const ShearStart start = make_walled_start(cell, 1);
  EXPECT_EQ(start.count(), 250 + 2 * start.wall_count);
  const double mean_volume = std::numbers::pi / 6.0 * std::pow(cell.grains.diameter, 3) *
                             (1.0 + std::pow(cell.grains.diameter_spread, 2));  // of a uniform diameter
  EXPECT_NEAR(start.free_volume() / (250 * mean_volume), 1.0, 0.05);
}

// The two codes must not differ in a single bit of the start.
TEST(ShearInput, BothCodesHoldTheIdenticalSpheres) {
  const ShearCell cell = read_shear_cell(tiny_shear_cell_file);
  const ShearStart start = make_periodic_start(cell, 1);
  std::istringstream spheres(yade_packing(start)), atoms(liggghts_packing(cell, start));
  std::string line;
  std::getline(spheres, line);
  while (line != "Atoms") ASSERT_TRUE(std::getline(atoms, line));
  for (Eigen::Index i = 0; i < start.count(); ++i) {
    Eigen::Vector3d yade_position, yade_velocity, position;
    double radius = 0.0, diameter = 0.0, density = 0.0;
    long id = 0, type = 0;
    for (double& value : yade_position) spheres >> value;
    for (double& value : yade_velocity) spheres >> value;
    ASSERT_TRUE(spheres >> radius);
    ASSERT_TRUE(atoms >> id >> type >> diameter >> density);
    for (double& value : position) ASSERT_TRUE(atoms >> value);
    EXPECT_EQ(id, i + 1);
    EXPECT_EQ(type, 1);
    EXPECT_EQ(density, cell.grains.density);
    EXPECT_EQ(position, start.positions.col(i));
    EXPECT_EQ(yade_position, start.positions.col(i));
    EXPECT_EQ(yade_velocity, start.velocities.col(i));
    EXPECT_EQ(radius, start.radii[i]);
    EXPECT_EQ(diameter, 2.0 * start.radii[i]);
  }
}

TEST(ShearInput, DecksHaveTheContactLaw) {
  const ShearCell cell = read_shear_cell(shear_cell_file);
  const ShearMaterial& rolling = cell.materials.at(1);
  const std::string deck = biaxial_deck(cell, rolling, cell.biaxial.points[0], make_periodic_start(cell, 1));
  EXPECT_THAT(deck, HasSubstr("coefficientRestitution peratomtypepair 1 0.5\n"));
  EXPECT_THAT(deck, HasSubstr("coefficientFriction peratomtypepair 1 0.5\n"));
  EXPECT_THAT(deck, HasSubstr("coefficientRollingFriction peratomtypepair 1 0.2\n"));
  EXPECT_THAT(deck, HasSubstr("youngsModulus peratomtype 5000000\n"));
  const auto parameters =
      yade_biaxial_parameters(cell, rolling, cell.biaxial.points[0], make_periodic_start(cell, 1));
  EXPECT_EQ(parameters["rolling_resistance"], 0.1);  // mu_r / 2
  EXPECT_EQ(parameters["restitution"], 0.5);
  EXPECT_EQ(parameters["friction"], 0.5);
  EXPECT_GT(parameters["rolling_stiffness_n_m"], 0.0);
  // A limit of 0 means to YADE that there is no limit: the spring itself must go.
  EXPECT_EQ(yade_biaxial_parameters(cell, cell.materials.at(0), cell.biaxial.points[0],
                                    make_periodic_start(cell, 1))["rolling_stiffness_n_m"],
            0.0);
}

// The load on the piston's spheres together is the normal stress on its area: 30 mm x 30 mm at 1 kPa is 0.9 N, on 10 x
// 10 spheres.
TEST(ShearInput, PistonCarriesTheNormalStress) {
  const ShearCell cell = read_shear_cell(shear_cell_file);
  const ShearStart start = make_walled_start(cell, 1);
  ASSERT_EQ(start.wall_count, 100);
  ASSERT_NEAR(start.size.x(), 0.03, 1e-12);
  const std::string deck = simple_shear_deck(cell, cell.materials[0], cell.simple_shear.points[0], start);
  const auto at = deck.find("aveforce NULL NULL ");
  ASSERT_NE(at, std::string::npos);
  EXPECT_NEAR(std::stod(deck.substr(at + 19)), -0.009, 1e-9);
}

// I = 0.1 at 1 kPa: 0.1 sqrt(1000 / 2500) / 0.003 = 21.08 per second.
TEST(ShearSchedule, RatesFollowFromTheInertialNumber) {
  const ShearCell cell = read_shear_cell(shear_cell_file);
  EXPECT_NEAR(wall_shear_rate(cell, {.inertial_number = 0.1, .transient_strain = 0, .strain = 1}), 21.08,
              0.01);
  EXPECT_NEAR(inertial_number_of(cell.grains, 21.08, 1000.0), 0.1, 1e-4);
  const BiaxialPoint slow{.inertial_number = 0.002, .axial_strain = 0.8, .averaged_from = 0.25};
  EXPECT_NEAR(axial_rate(cell, slow), 0.2108, 1e-4);
  EXPECT_EQ(step_count(cell, slow) % cell.protocol.steps_per_sample, 0);
  EXPECT_NEAR(static_cast<double>(step_count(cell, slow)) * cell.protocol.time_step * 0.2108, 0.8, 1e-3);
}

TEST(ShearRuns, AreAllPlannedOnce) {
  const ShearCell cell = read_shear_cell(shear_cell_file);
  std::set<std::string> seen;
  int yade = 0;
  for (const PlannedRun& run : shear_cell_runs(cell)) {
    EXPECT_TRUE(seen.insert(run.point_name + run.code + std::to_string(run.seed)).second) << run.point_name;
    yade += run.code == "yade";
  }
  EXPECT_EQ(seen.size(), 2U * (4 * 3 + 1 + 4 * 3));
  EXPECT_EQ(yade, 2);
}

}  // namespace
}  // namespace talus::dem
