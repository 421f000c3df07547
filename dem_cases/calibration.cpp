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

/// All of the law or nothing of it.
std::optional<FrictionLaw> read_friction_law(const CheckedTable& table) {
  if (!table.has("mu_1") && !table.has("mu_2") && !table.has("I_0")) return std::nullopt;
  constexpr Range friction{0.01, 10.0}, friction_uncertainty{0.0, 10.0};
  const FrictionLaw law{
      .mu_1 = table.number("mu_1", friction),
      .mu_1_uncertainty = table.number("mu_1_uncertainty", friction_uncertainty),
      .mu_2 = table.number("mu_2", friction),
      .mu_2_uncertainty = table.number("mu_2_uncertainty", friction_uncertainty),
      .I_0 = table.number("I_0", {1e-4, 100.0}),
      .I_0_uncertainty = table.number("I_0_uncertainty", {0.0, 100.0}),
  };
  if (!(law.mu_2 > law.mu_1))
    throw table.error("mu_2", fmt::format("must be above mu_1 = {}: friction grows with the rate", law.mu_1));
  return law;
}

MaterialConstants read_material(const CheckedTable& table) {
  MaterialConstants constants{
      .friction_angle = degree * table.number("friction_angle_deg", {1.0, 60.0}),
      .friction_angle_uncertainty = degree * table.number("friction_angle_uncertainty_deg", {0.0, 20.0}),
      .max_volume_fraction = table.number("max_volume_fraction", {0.3, 0.75}),
      .max_volume_fraction_uncertainty = table.number("max_volume_fraction_uncertainty", {0.0, 0.1}),
      .status = table.choice("status", statuses),
      .source = table.string("source"),
      .friction_law = read_friction_law(table),
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
