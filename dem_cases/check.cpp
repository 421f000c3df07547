#include "dem_cases/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "continuum/files/checked_table.h"
#include "continuum/files/memory.h"
#include "dem_cases/shear_cell/shear_cell.h"
#include "dem_cases/time_step.h"

namespace talus::dem {
namespace {

struct Opening {
  const char* key;
  double width;  // m, across
};

/// What the grains have to pass; of width 0 where they need not.
Opening opening_of(const Case& a_case) {
  if (const auto* slot = std::get_if<SlotGeometry>(&a_case.geometry)) return {"opening_m", slot->opening};
  if (const auto* glass = std::get_if<HourglassGeometry>(&a_case.geometry))
    return {"throat_radius_m", 2.0 * glass->throat_radius};
  return {"", 0.0};
}

std::string needs_of(const Case& a_case, const TimeStepCheck& step) {
  const StepSchedule schedule = step_schedule(a_case);
  return fmt::format(
      "{}: point {}: about {:.3g} grains and {} of memory, {:.3g} steps of {:.3g} s ({:.0f} % of the "
      "Rayleigh "
      "time, {:.0f} % of the Hertz time; at most {:.0f} and {:.0f}), {} snapshots",
      a_case.file.string(), a_case.point, expected_grains(a_case), memory_text(expected_memory(a_case)),
      static_cast<double>(schedule.settle + schedule.run()), a_case.protocol.time_step,
      100.0 * step.rayleigh_fraction, 100.0 * step.hertz_fraction, 100.0 * largest_rayleigh_fraction,
      100.0 * largest_hertz_fraction, schedule.snapshot_count);
}

void check_point(const std::filesystem::path& file, const std::string& name, CaseCheck& found) {
  passes(found.faults, [&] {
    const Case a_case = read_case(file, name);
    std::ranges::move(case_warnings(a_case, memory_available()), std::back_inserter(found.warnings));
    found.needs.push_back(needs_of(a_case, check_time_step(a_case)));
  });
}

/// A fault each, once: points share the file's own keys, and so their faults.
void drop_repeated(Faults& faults) {
  Faults once;
  for (const auto& fault : faults) {
    std::istringstream lines(fault);
    for (std::string line; std::getline(lines, line);) {
      if (std::ranges::find(once, line) == once.end()) once.push_back(line);
    }
  }
  faults = std::move(once);
}

}  // namespace

double expected_memory(const Case& a_case) {
  constexpr double at_start = 200e6, per_grain = 10e3;
  return at_start + per_grain * expected_grains(a_case);
}

std::vector<std::string> case_warnings(const Case& a_case, double memory) {
  std::vector<std::string> warnings;
  const double diameter = a_case.grains.diameter;
  const auto tell = [&](std::string_view key, const std::string& what) {
    warnings.push_back(
        fmt::format("{}: point {}: key '{}' {}", a_case.file.string(), a_case.point, key, what));
  };
  if (const Opening opening = opening_of(a_case);
      opening.width > 0.0 && opening.width < least_opening_diameters * diameter * (1.0 - 1e-9)) {
    tell(
        fmt::format("geometry.{}", opening.key),
        fmt::format(
            "leaves an opening of {:.3g} m, {:.3g} grain diameters; below {:.0f} grains arch over it and the "
            "flow may stop; use at least {:.3g} m across",
            opening.width, opening.width / diameter, least_opening_diameters,
            least_opening_diameters * diameter));
  }
  if (const double grains = expected_grains(a_case); grains < fewest_grains) {
    tell("grains.diameter_m",
         fmt::format("= {} makes about {:.0f} grains; figures of fewer than {:.0f} scatter much from "
                     "seed to seed; use smaller grains or more sand",
                     diameter, grains, fewest_grains));
  }
  if (const double needed = expected_memory(a_case); needed > memory) {
    tell("grains.diameter_m",
         fmt::format("= {} makes about {:.3g} grains, which need about {}; {} are free; use larger grains or "
                     "less sand",
                     diameter, expected_grains(a_case), memory_text(needed), memory_text(memory)));
  }
  return warnings;
}

CaseCheck check_case_file(const std::filesystem::path& file) {
  CaseCheck found;
  std::vector<std::string> points{""};
  bool shear_cell = false;
  const bool readable = passes(found.faults, [&] {
    shear_cell = CheckedTable::parse_file(file).string("kind") == "shear_cell";
    if (!shear_cell) std::ranges::move(CheckedTable::point_names(file), std::back_inserter(points));
  });
  if (!readable) return found;
  if (shear_cell) {
    passes(found.faults, [&] {
      const ShearCell cell = read_shear_cell(file);
      found.needs.push_back(
          fmt::format("{}: a shear cell of {} materials", file.string(), cell.materials.size()));
    });
    return found;
  }
  for (const std::string& point : points) check_point(file, point, found);
  if (found.faults.empty())
    passes(found.faults, [&] { read_case_points(file); });  // names that two points share
  drop_repeated(found.faults);
  return found;
}

}  // namespace talus::dem
