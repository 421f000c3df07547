// How round the splash of continuum/scenes/seed/splash.toml is.
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstdint>

#include "continuum/scene/scene.h"

namespace talus::testing {

/// By how much what is thrown up goes further in some directions than in others: the larger of the amplitudes of two and four
/// periods around the axis in the mean distance from it, over that distance; of particles that rise by more than 0.1 m/s
/// outside the sphere's radius. Chance alone gives sqrt(2 / particles). Several runs add up.
struct Splash {
  double radii = 0.0;  // kg m
  std::array<std::complex<double>, 2> waves{};
  int particles = 0;

  void add(const State& state) {
    for (Eigen::Index p = 0; p < state.particles.count(); ++p) {
      const Eigen::Vector3d x = state.particles.positions.col(p) - Eigen::Vector3d(0.1, 0.1, 0.0);
      const double m = state.particles.masses[p], r = std::hypot(x[0], x[1]), angle = std::atan2(x[1], x[0]);
      if (state.particles.velocities(2, p) < 0.1 || r < 0.013 || x[2] < 0.07) continue;
      radii += m * r;
      ++particles;
      for (std::size_t k = 0; k < 2; ++k)
        waves[k] += 2.0 * m * r * std::polar(1.0, (k == 0 ? 2.0 : 4.0) * angle);
    }
  }
  double anisotropy() const { return std::max(std::abs(waves[0]), std::abs(waves[1])) / radii; }
  double by_chance() const { return std::sqrt(2.0 / particles); }
};

inline constexpr std::array<double, 3> splash_moments{0.02, 0.04, 0.06};  // s

/// The splash after each of these, of arrangements of the same sand, with seeds 1, 2 ..., together.
inline std::array<Splash, 3> splashes(Scene scene, int arrangements) {
  std::array<Splash, 3> found;
  for (int seed = 1; seed <= arrangements; ++seed) {
    scene.seed = static_cast<std::uint64_t>(seed);
    State state = initial_state(scene);
    for (std::size_t moment = 0; moment < found.size(); ++moment) {
      while (splash_moments[moment] - state.time > 1e-9)
        step(state, scene.settings, splash_moments[moment] - state.time);
      found[moment].add(state);
    }
  }
  return found;
}

}  // namespace talus::testing
