// The discrete codes' time step: its preflight, made on every deck before it runs, and how many of them a run
// takes.
//
//   Rayleigh  T_R = pi r sqrt(rho / G) / (0.1631 nu + 0.8766)    time of a surface wave around the smallest grain
//   Hertz     T_H = 2.87 (m*^2 / (R* E*^2 v))^(1/5)              duration of a collision at the largest speed
// (Thornton & Randall 1988; Johnson, Contact Mechanics 1985, eq. 11.24; the same pair that LIGGGHTS checks.)
#pragma once

#include <cstdint>
#include <filesystem>

#include "dem_cases/case.h"

namespace talus::dem {

inline constexpr double largest_rayleigh_fraction = 0.3;
inline constexpr double largest_hertz_fraction = 0.2;

struct TimeStepCheck {
  double rayleigh_time;      // s
  double hertz_time;         // s
  double rayleigh_fraction;  // time_step / rayleigh_time
  double hertz_fraction;     // time_step / hertz_time
};

/// Throws InputError naming the case file when either fraction is above its limit.
TimeStepCheck check_time_step(const Case& column);

/// The same for grains that meet at `largest_speed`, in m/s, whatever moves them.
TimeStepCheck check_time_step(const Grains& grains, double time_step, double largest_speed,
                              const std::filesystem::path& case_file);

/// Steps of a run. read_case() has made sure that all of them are whole.
struct StepSchedule {
  std::int64_t settle;          // before the gate opens
  std::int64_t per_snapshot;    // between snapshots
  std::int64_t snapshot_count;  // after the release, without the one at the release itself

  std::int64_t run() const { return per_snapshot * snapshot_count; }
};

StepSchedule step_schedule(const Case& column);

}  // namespace talus::dem
