// Small scenes that tests build in code.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <numeric>
#include <string_view>
#include <vector>

#include "continuum/scene/scene.h"

namespace talus::testing {

inline constexpr double gravity = 9.81;

inline double mu_of_deg(double angle) { return std::tan(angle * std::numbers::pi / 180.0); }

/// Fills the box between two corners with a material.
inline Filling box_of(std::size_t material, const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  return {material, Shape{Box{0.5 * (lower + upper), 0.5 * (upper - lower)}}};
}

/// A box of sand of `size` cells at the origin of an empty domain of `cells`; floor and sides open, nothing
/// periodic.
inline Scene box_scene(const Eigen::Vector3i& cells, const Eigen::Vector3d& size, double h, double friction) {
  Scene scene{};
  scene.grid = {Eigen::Vector3d::Zero(), h, cells, {false, false, false}};
  scene.gravity = {0.0, 0.0, -gravity};
  scene.materials = {{"sand", 2500.0, 0.6, friction, {}}};
  scene.fillings = {box_of(0, Eigen::Vector3d::Zero(), h * size)};
  scene.particles_per_cell = {2, 2, 2};
  scene.jitter = 0.0;
  scene.seed = 1;
  return scene;
}

/// The default settings; with TALUS_TEST_SCHEME=paper in the environment, those with the scheme of the source. That is how
/// its column in physics/README.md is measured: the tests print their figures, and fail where it fails.
inline StepSettings step_settings() {
  StepSettings settings;
  const char* scheme = std::getenv("TALUS_TEST_SCHEME");
  if (scheme && std::string_view(scheme) == "paper") settings.scheme = Scheme::paper;
  return settings;
}

/// Runs for `duration` seconds; calls observe(state, report) after each step.
template <class Observe>
void run_for(State& state, const StepSettings& settings, double duration, Observe&& observe) {
  const double end = state.time + duration;
  while (end - state.time > 1e-12) observe(state, step(state, settings, end - state.time));
}

/// Makes each particle's mass its own, by parts in 1e12: a step reorders particles, and by that they are found again.
inline void tag(State& state) {
  for (Eigen::Index p = 0; p < state.particles.count(); ++p)
    state.particles.masses[p] *= 1.0 + 1e-12 * static_cast<double>(p);
}
/// Positions in the order of the tags, 3 x n; the same particles must still be there.
inline Eigen::Matrix3Xd positions_by_tag(const State& state) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(state.particles.count()));
  std::iota(order.begin(), order.end(), 0);
  const auto& masses = state.particles.masses;
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return masses[a] < masses[b]; });
  return state.particles.positions(Eigen::all, order);
}

inline double mean_velocity(const State& state, int axis) {
  const Particles& p = state.particles;
  return (p.masses * p.velocities.row(axis).transpose().array()).sum() / p.masses.sum();
}

}  // namespace talus::testing
