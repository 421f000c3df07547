// What must hold of any run of the continuum, whatever grains do: laws that need no discrete code to be judged by.
#pragma once

#include <array>
#include <filesystem>

namespace talus::validation {

/// Means over the last tenth of a run's time, or of the time until all sand has left.
struct Balances {
  /// Mass over bulk volume, as a share of the densest that is allowed: 1, and more where cells are overfull.
  double bulk_density;
  /// The force of floor, walls and bodies against gravity, as a share of the sand's weight: 1 at rest.
  double support;
};

/// Reads the budget.csv of a run. `densest_bulk` is grain density times packing limit, kg/m^3; `gravity` m/s^2, along -z. Throws
/// analysis::SnapshotError naming file and line where it cannot be read, or no step has sand.
Balances read_balances(const std::filesystem::path& budget, double densest_bulk, double gravity);

/// The same as laws for the truth gate: observables that are exactly 1.
struct ExactLaw {
  const char* observable;
  double band;  // relative
  const char* why;
};
inline constexpr std::array exact_laws{
    ExactLaw{"bulk_density", 0.01, "no sand is denser than its packing limit; exact, so held to 1 %"},
    ExactLaw{"support", 0.01,
             "at rest floor, walls and bodies bear the sand's weight; exact, so held to 1 %"},
};

}  // namespace talus::validation
