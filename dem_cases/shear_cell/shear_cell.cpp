#include "dem_cases/shear_cell/shear_cell.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include "continuum/files/checked_table.h"
#include "dem_cases/time_step.h"

namespace talus::dem {
namespace {

constexpr int fewest_grains_along = 4;  // fewer, and a grain would meet its own image
constexpr int most_grains_along = 1000;

std::vector<ShearMaterial> read_materials(const CheckedTable& root) {
  std::vector<ShearMaterial> materials;
  std::set<std::string> seen;
  for (const auto& table : root.tables("material")) {
    materials.push_back({table.string("name"), table.number("rolling_friction", {0.0, 2.0})});
    table.finish();
    const std::string& name = materials.back().name;
    const bool plain =
        !name.empty() && name.size() <= 100 &&
        std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) || c == '_'; });
    if (!plain) throw table.error("name", "must be letters, digits and '_': it names folders and tables");
    if (!seen.insert(name).second) throw table.error("name", "is given twice; give each material once");
  }
  return materials;
}

ShearProtocol read_protocol(const CheckedTable& table) {
  const ShearProtocol protocol{
      .time_step = table.number("time_step_s", {smallest_positive, 0.1}),
      .compression_time = table.number("compression_time_s", {smallest_positive, 1000.0}),
      .closing_speed = table.number("closing_speed_m_s", {smallest_positive, 100.0}),
      .stress_tolerance = table.number("stress_tolerance", {smallest_positive, 0.2}),
      .inertial_tolerance = table.number("inertial_tolerance", {smallest_positive, 0.5}),
      .least_strain = table.number("least_strain", {0.01, 100.0}),
      .steps_per_sample = static_cast<int>(table.integer("steps_per_sample", 1, 1000)),
  };
  table.finish();
  return protocol;
}

std::vector<std::uint64_t> read_seeds(const CheckedTable& table, std::string_view key) {
  std::vector<std::uint64_t> seeds;
  for (const auto seed : table.integers(key, 0, 1'000'000'000))
    seeds.push_back(static_cast<std::uint64_t>(seed));
  return seeds;
}

/// Beyond this the overlaps, not the grains' friction, would decide what is measured.
Range stress_range(const Grains& grains) {
  constexpr double most_of_youngs_modulus = 1e-3;
  return {smallest_positive, most_of_youngs_modulus * grains.youngs_modulus};
}

SimpleShear read_simple_shear(const CheckedTable& table, const Grains& grains,
                              const ShearProtocol& protocol) {
  SimpleShear shear{
      .normal_stress = table.number("normal_stress_pa", stress_range(grains)),
      .lattice = table.integer_vector("lattice", fewest_grains_along, most_grains_along),
      .points = {},
      .liggghts_seeds = read_seeds(table, "liggghts_seeds"),
  };
  for (const auto& point : table.tables("point")) {
    shear.points.push_back({.inertial_number = point.number("inertial_number", {1e-5, 1.0}),
                            .transient_strain = point.number("transient_strain", {0.0, 1000.0}),
                            .strain = point.number("strain", {protocol.least_strain, 1000.0})});
    point.finish();
  }
  table.finish();
  return shear;
}

BiaxialPoint read_biaxial_point(const CheckedTable& table, const ShearProtocol& protocol) {
  const BiaxialPoint point{.inertial_number = table.number("inertial_number", {1e-5, 0.1}),
                           .axial_strain = table.number("axial_strain", {0.01, 1.5}),
                           .averaged_from = table.number("averaged_from", {0.0, 1.5})};
  table.finish();
  if (2.0 * (point.axial_strain - point.averaged_from) < protocol.least_strain) {
    throw table.error("averaged_from",
                      fmt::format("leaves less than a shear strain of {}: 2 (axial_strain - averaged_from)",
                                  protocol.least_strain));
  }
  return point;
}

Biaxial read_biaxial(const CheckedTable& table, const Grains& grains, const ShearProtocol& protocol) {
  Biaxial biaxial{
      .lateral_stress = table.number("lateral_stress_pa", stress_range(grains)),
      .servo_gain = table.number("servo_gain_per_s", {smallest_positive, 100.0}),
      .closing_rate = table.number("closing_rate_per_s", {smallest_positive, 100.0}),
      .lattice = table.integer_vector("lattice", fewest_grains_along, most_grains_along),
      .points = {},
      .liggghts_seeds = read_seeds(table, "liggghts_seeds"),
      .yade_seeds = read_seeds(table, "yade_seeds"),
  };
  for (const auto& point : table.tables("point")) {
    biaxial.points.push_back(read_biaxial_point(point, protocol));
    if (biaxial.points.back().inertial_number < biaxial.points.front().inertial_number)
      throw point.error("inertial_number", "is below that of the first point, which is to be the slowest");
  }
  table.finish();
  return biaxial;
}

}  // namespace

ShearCell read_shear_cell(const std::filesystem::path& file) {
  const auto root = CheckedTable::parse_file(file);
  root.require_schema(1);
  constexpr std::array<std::string_view, 1> kinds{"shear_cell"};
  root.choice("kind", kinds);
  ShearCell cell;
  cell.file = file;
  cell.name = read_folder_name(root, "name");
  cell.title = root.string("title");
  cell.grains = read_grains(root.table("grains"));
  const auto contact = root.table("contact");
  cell.restitution = contact.number("restitution", {0.05, 1.0});
  cell.friction = contact.number("friction", {0.0, 2.0});
  contact.finish();
  cell.materials = read_materials(root);
  cell.protocol = read_protocol(root.table("protocol"));
  cell.simple_shear = read_simple_shear(root.table("simple_shear"), cell.grains, cell.protocol);
  cell.biaxial = read_biaxial(root.table("biaxial"), cell.grains, cell.protocol);
  root.finish();
  check_time_step(cell.grains, cell.protocol.time_step, cell.protocol.closing_speed, file);
  return cell;
}

}  // namespace talus::dem
