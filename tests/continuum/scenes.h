// Small scenes that tests build in code.
#pragma once

#include <cmath>
#include <numbers>

#include "continuum/scene/scene.h"

namespace talus::testing {

inline constexpr double gravity = 9.81;

inline double mu_of_deg(double angle) { return std::tan(angle * std::numbers::pi / 180.0); }

/// A box of sand of `size` cells at the origin of an empty domain of `cells`; floor and sides open, nothing
/// periodic.
inline Scene box_scene(const Eigen::Vector3i& cells, const Eigen::Vector3d& size, double h, double friction) {
  Scene scene{};
  scene.grid = {Eigen::Vector3d::Zero(), h, cells, {false, false, false}};
  scene.gravity = {0.0, 0.0, -gravity};
  scene.materials = {{"sand", 2500.0, 0.6, friction}};
  scene.boxes = {{0, Eigen::Vector3d::Zero(), h * size}};
  scene.particles_per_cell = 2;
  scene.jitter = 0.0;
  scene.seed = 1;
  return scene;
}

/// Runs for `duration` seconds; calls observe(state, report) after each step.
template <class Observe>
void run_for(State& state, const StepSettings& settings, double duration, Observe&& observe) {
  const double end = state.time + duration;
  while (end - state.time > 1e-12) observe(state, step(state, settings, end - state.time));
}

inline double mean_velocity(const State& state, int axis) {
  const Particles& p = state.particles;
  return (p.masses * p.velocities.row(axis).transpose().array()).sum() / p.masses.sum();
}

}  // namespace talus::testing
