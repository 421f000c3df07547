// Where the time of a step goes: wall-clock seconds, phase by phase. About 20 readings of the clock a step, 25 ns each.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <numeric>
#include <string_view>

namespace talus {

/// The parts of a step that cost something, in the order of figure 5.7.
enum class Phase {
  region,         // which cells hold particles, and their tables
  packing,        // density correction
  deposit,        // particles to grid, friction coefficients
  carry_over,     // the last step's stress as warm start
  friction,       // friction solves, with their yield radii
  pressure,       // pressure solves
  stress_other,   // what both solves need, and what follows them
  move,           // grid to particles, their shapes and motion, walls
  reshape,        // split and merge
  render_points,  // where there are any
  warm_start,     // what is kept for the next step
  other,          // the time step; sources and gates
};
inline constexpr auto phase_names = std::to_array<std::string_view>(  // as many as there are strings
    {"region", "packing", "deposit", "carry_over", "friction", "pressure", "stress_other", "move", "reshape",
     "render_points", "warm_start", "other"});
static_assert(static_cast<std::size_t>(Phase::other) + 1 == phase_names.size());

/// Seconds of each phase.
struct PhaseSeconds {
  std::array<double, phase_names.size()> of{};

  double& operator[](Phase phase) { return of[static_cast<std::size_t>(phase)]; }
  double operator[](Phase phase) const { return of[static_cast<std::size_t>(phase)]; }
  PhaseSeconds& operator+=(const PhaseSeconds& other) {
    for (std::size_t i = 0; i < of.size(); ++i) of[i] += other.of[i];
    return *this;
  }
  double total() const { return std::accumulate(of.begin(), of.end(), 0.0); }
};

/// A clock that is read again and again.
class Stopwatch {
 public:
  /// Seconds since the last lap, or since the start.
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> passed = now - last_;
    last_ = now;
    return passed.count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace talus
