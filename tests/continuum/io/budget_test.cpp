// The books of a hand-made state, and that they close.
#include "continuum/io/budget.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/continuum/particles/particle_sums.h"
#include "tests/continuum/scenes.h"

namespace talus {
namespace {

using Eigen::Vector3d;

/// Two particles in a domain whose lower corner is not the origin.
State two_particles() {
  Scene scene = testing::box_scene({4, 4, 4}, {1.0, 1.0, 1.0}, 0.5, 0.5);
  scene.grid.origin = {10.0, 0.0, -1.0};
  scene.fillings.clear();
  State state = initial_state(scene);
  state.gravity = {1.0, 0.0, -10.0};
  testing::add_particle({10.5, 1.0, 0.0}, 2.0, 1e-3 * Eigen::Matrix3d::Identity(), state.particles);
  testing::add_particle({11.0, 0.5, 0.5}, 3.0, 1e-3 * Eigen::Matrix3d::Identity(), state.particles);
  state.particles.velocities.col(0) = Vector3d(1.0, 2.0, 3.0);
  state.particles.velocities.col(1) = Vector3d(0.0, -1.0, 1.0);
  return state;
}
// 1/2 2 14 + 1/2 3 2; and - m g . (x - corner): 2 (10 1 - 0.5) + 3 (10 1.5 - 1).
constexpr double kinetic = 17.0, potential = 19.0 + 42.0;

std::map<std::string, double> row_of(const Budget& budget) {
  std::istringstream names(Budget::header()), values(budget.row());
  std::map<std::string, double> row;
  for (std::string name, value; std::getline(names, name, ',');) {
    EXPECT_TRUE(std::getline(values, value, ',')) << name;
    row[name.substr(0, name.find('\n'))] = std::stod(value);
  }
  std::string more;
  EXPECT_FALSE(std::getline(values, more, ',')) << more;
  return row;
}

TEST(Budget, EnergyAndMomentumOfAHandMadeState) {
  State state = two_particles();
  EXPECT_DOUBLE_EQ(total_energy(state), kinetic + potential);
  Budget budget(state);
  EXPECT_EQ(budget.summary()["mass_kg"], 5.0);
  EXPECT_DOUBLE_EQ(budget.summary()["energy_start_j"], kinetic + potential);
  EXPECT_DOUBLE_EQ(budget.summary()["energy_highest_j"], kinetic + potential);
  EXPECT_EQ(budget.summary()["steps"], 0);
  state.time = 0.25;
  budget.add(state, {});
  const auto row = row_of(budget);
  EXPECT_EQ(row.at("step"), 1.0);
  EXPECT_EQ(row.at("time_s"), 0.25);
  EXPECT_EQ(row.at("particles"), 2.0);
  EXPECT_EQ(row.at("mass_kg"), 5.0);
  EXPECT_DOUBLE_EQ(row.at("momentum_x_kg_m_s"), 2.0);
  EXPECT_DOUBLE_EQ(row.at("momentum_y_kg_m_s"), 1.0);
  EXPECT_DOUBLE_EQ(row.at("momentum_z_kg_m_s"), 9.0);
  EXPECT_DOUBLE_EQ(row.at("kinetic_energy_j"), kinetic);
  EXPECT_DOUBLE_EQ(row.at("potential_energy_j"), potential);
}

TEST(Budget, WhatAStepReportsIsInItsRowAndInTheSums) {
  State state = two_particles();
  Budget budget(state);
  StepReport report;
  report.dt = 0.5;
  report.projection.friction_iterations = 7;
  report.projection.pressure_iterations = 5;
  report.projection.cap_hits = 2;
  report.packing.solve.iterations = 3;
  report.packing.solve.converged = false;  // the third cap
  report.packing.peak_fill = 1.25;
  report.packing.bulk_volume = 0.75;
  report.collisions.count = 11;
  report.collisions.deepest = 0.125;
  report.reshape.split.splits = 13;
  report.reshape.merge.merges = 17;
  report.largest_move = 0.375;
  report.retries = 1;
  report.collisions.impulse = {1.5, 2.5, 3.5};
  report.solids_impulse = {4.5, 5.5, 6.5};
  budget.add(state, report);
  const auto row = row_of(budget);
  const std::map<std::string, double> expected{{"dt_s", 0.5},
                                               {"friction_iterations", 7},
                                               {"pressure_iterations", 5},
                                               {"cap_hits", 3},
                                               {"peak_fill", 1.25},
                                               {"packing_iterations", 3},
                                               {"bulk_volume_m3", 0.75},
                                               {"wall_collisions", 11},
                                               {"splits", 13},
                                               {"merges", 17},
                                               {"largest_move_cells", 0.375},
                                               {"wall_impulse_x_kg_m_s", 1.5},
                                               {"wall_impulse_y_kg_m_s", 2.5},
                                               {"wall_impulse_z_kg_m_s", 3.5},
                                               {"solids_impulse_x_kg_m_s", 4.5},
                                               {"solids_impulse_y_kg_m_s", 5.5},
                                               {"solids_impulse_z_kg_m_s", 6.5},
                                               {"retries", 1}};
  for (const auto& [name, value] : expected) EXPECT_EQ(row.at(name), value) << name;
  report.dt = 0.25;
  report.packing.peak_fill = 1.0;
  report.packing.solve.converged = true;
  report.collisions.deepest = 0.0;
  budget.add(state, report);
  const auto sums = budget.summary();
  EXPECT_EQ(sums["steps"], 2);
  EXPECT_EQ(sums["friction_iterations"], 14);
  EXPECT_EQ(sums["pressure_iterations"], 10);
  EXPECT_EQ(sums["packing_iterations"], 6);
  EXPECT_EQ(sums["cap_hits"], 5);
  EXPECT_EQ(sums["converged"], false);
  EXPECT_EQ(sums["splits"], 26);
  EXPECT_EQ(sums["merges"], 34);
  EXPECT_EQ(sums["shortest_step_s"], 0.25);
  EXPECT_EQ(sums["longest_step_s"], 0.5);
  EXPECT_EQ(sums["peak_fill"], 1.25);
  EXPECT_EQ(sums["deepest_collision_m"], 0.125);
}

TEST(Budget, MassErrorClosesWhenParticlesComeAndGoAndNotWhenTheyVanish) {
  State state = two_particles();
  Budget budget(state);
  StepReport report;
  state.particles.resize(1);  // the second leaves,
  report.mass_left = 3.0;
  report.particles_left = 1;
  budget.add(state, report);
  EXPECT_EQ(budget.summary()["mass_error"], 0.0);
  EXPECT_EQ(budget.summary()["particles_left"], 1);
  report = {};
  testing::add_particle({10.5, 1.0, 0.0}, 4.0, Eigen::Matrix3d::Identity(),
                        state.particles);  // another comes,
  report.mass_added = 4.0;
  budget.add(state, report);
  EXPECT_EQ(budget.summary()["mass_error"], 0.0);
  EXPECT_EQ(budget.summary()["mass_left_kg"], 3.0);
  EXPECT_EQ(budget.summary()["mass_added_kg"], 4.0);
  state.particles.resize(1);  // and is lost unreported.
  budget.add(state, {});
  EXPECT_NEAR(budget.summary()["mass_error"].get<double>(), -4.0 / 9.0, 1e-15);
}

TEST(Budget, HighestEnergyIsOverAllSteps) {
  State state = two_particles();
  Budget budget(state);
  state.particles.velocities.col(0) *= 2.0;
  budget.add(state, {});
  state.particles.velocities.setZero();
  budget.add(state, {});
  EXPECT_DOUBLE_EQ(budget.summary()["energy_highest_j"], 4.0 * 14.0 + 3.0 + potential);
  EXPECT_DOUBLE_EQ(budget.summary()["energy_start_j"], kinetic + potential);
}

}  // namespace
}  // namespace talus
