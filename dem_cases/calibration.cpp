#include "dem_cases/calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <numbers>
#include <optional>
#include <string_view>
#include <vector>

#include "continuum/files/checked_table.h"

namespace talus::dem {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr std::array<std::string_view, 2> statuses{"provisional", "calibrated"};

MaterialConstants read_material(const CheckedTable& table) {
  MaterialConstants constants{
      .friction_angle = degree * table.number("friction_angle_deg", {1.0, 60.0}),
      .friction_angle_uncertainty = degree * table.number("friction_angle_uncertainty_deg", {0.0, 20.0}),
      .max_volume_fraction = table.number("max_volume_fraction", {0.3, 0.75}),
      .max_volume_fraction_uncertainty = table.number("max_volume_fraction_uncertainty", {0.0, 0.1}),
      .status = table.choice("status", statuses),
      .source = table.string("source"),
  };
  table.finish();
  return constants;
}

}  // namespace

MaterialConstants read_calibration(const std::filesystem::path& file, const std::string& material_name) {
  const auto root = CheckedTable::parse_file(file);
  root.require_schema(1);
  std::optional<MaterialConstants> found;
  std::vector<std::string> names;
  for (const auto& [name, table] : root.named_tables()) {
    const MaterialConstants constants = read_material(table);
    if (name == material_name) found = constants;
    names.push_back(name);
  }
  root.finish();
  if (!found) {
    throw InputError(fmt::format(
        "{}: there is no material [{}]; this file has: {}; name one of them in the case, or add it",
        file.string(), material_name, fmt::join(names, ", ")));
  }
  return *found;
}

}  // namespace talus::dem
