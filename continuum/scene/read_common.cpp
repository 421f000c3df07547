#include "continuum/scene/read_common.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "continuum/solids/wall.h"

namespace talus {

std::vector<CheckedTable> up_to_most_tables(const CheckedTable& root, std::string_view key) {
  if (!root.has(key)) return {};
  std::vector<CheckedTable> tables = root.tables(key);
  if (tables.size() > most_tables) {
    throw InputError(fmt::format("{}: has {} tables [[{}]]; at most {}", root.file().string(), tables.size(),
                                 key, most_tables));
  }
  return tables;
}

double friction_of_angle_deg(double angle) { return std::tan(angle * std::numbers::pi / 180.0); }

double read_solid_friction(const CheckedTable& table) {
  if (table.boolean("rough", false)) {
    if (table.has("friction_angle_deg"))
      throw table.error("friction_angle_deg", "what is rough has the sand's; remove this");
    return as_rough_as_sand;
  }
  return friction_of_angle_deg(table.number("friction_angle_deg", {0.0, largest_friction_angle_deg}));
}

bool holds(const Grid& grid, const Eigen::AlignedBox3d& box) {
  const double slack = 1e-9 * grid.spacing;
  return (box.min().array() >= grid.origin.array() - slack).all() &&
         (box.max().array() <= grid.upper().array() + slack).all();
}

}  // namespace talus
