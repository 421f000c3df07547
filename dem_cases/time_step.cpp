#include "dem_cases/time_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "continuum/files/checked_table.h"
#include "dem_cases/container.h"

namespace talus::dem {

TimeStepCheck check_time_step(const Case& column) {
  // A grain that falls freely through twice the fill's height: the loose packing is about that tall; or through
  // the height of the fill and down to the lowest floor.
  const double height = fill_height(column.geometry);
  const double fall = std::max(2.0 * height, height - container_of(column).lowest);
  double largest_speed = std::sqrt(2.0 * column.protocol.gravity * fall);
  if (const auto* impact = std::get_if<ImpactGeometry>(&column.geometry))
    largest_speed = std::max(largest_speed, impact->impact_speed);
  return check_time_step(column.grains, column.protocol.time_step, largest_speed, column.file);
}

TimeStepCheck check_time_step(const Grains& grains, double step, double largest_speed,
                              const std::filesystem::path& case_file) {
  const double radius =
      0.5 * grains.diameter * (1.0 - grains.diameter_spread);  // the smallest grain sets both times
  const double shear_modulus = grains.youngs_modulus / (2.0 * (1.0 + grains.poissons_ratio));
  const double rayleigh_time = std::numbers::pi * radius * std::sqrt(grains.density / shear_modulus) /
                               (0.1631 * grains.poissons_ratio + 0.8766);

  const double mass = grains.density * 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3);
  const double effective_mass = mass / 2.0, effective_radius = radius / 2.0;
  const double effective_modulus =
      grains.youngs_modulus / (2.0 * (1.0 - grains.poissons_ratio * grains.poissons_ratio));
  const double hertz_time =
      2.87 * std::pow(effective_mass * effective_mass /
                          (effective_radius * effective_modulus * effective_modulus * largest_speed),
                      0.2);

  const TimeStepCheck check{rayleigh_time, hertz_time, step / rayleigh_time, step / hertz_time};
  const double largest_step =
      std::min(largest_rayleigh_fraction * rayleigh_time, largest_hertz_fraction * hertz_time);
  if (!(step <= largest_step)) {
    throw InputError(fmt::format(
        "{}: key 'protocol.time_step_s' = {:.6g}: is {:.0f} % of the Rayleigh time and {:.0f} % of the Hertz "
        "time of the "
        "smallest grain; allowed are {:.0f} % and {:.0f} %; use at most {:.3g} s or softer grains",
        case_file.string(), step, 100 * check.rayleigh_fraction, 100 * check.hertz_fraction,
        100 * largest_rayleigh_fraction, 100 * largest_hertz_fraction, largest_step));
  }
  return check;
}

StepSchedule step_schedule(const Case& column) {
  const Protocol& protocol = column.protocol;
  return {.settle = std::llround(protocol.settle_time / protocol.time_step),
          .per_snapshot = std::llround(protocol.snapshot_interval / protocol.time_step),
          .snapshot_count = std::llround(protocol.run_time / protocol.snapshot_interval)};
}

}  // namespace talus::dem
