#include "dem_cases/case.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string_view>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "continuum/files/provenance.h"

namespace talus::dem {
namespace {

constexpr std::array<std::string_view, 2> floors{"rough", "flat"};
constexpr std::array<std::string_view, 6> observables{"runout",         "x90",          "x95",
                                                      "centre_of_mass", "final_height", "stop_time"};

/// `whole` must be a whole number of `part`: the discrete codes count steps, and snapshots must fall on them.
void require_multiple(const CheckedTable& table, std::string_view key, double whole,
                      std::string_view part_key, double part) {
  const double count = whole / part;
  if (!(count >= 0.5 && std::abs(count - std::round(count)) <= 1e-6 * count)) {
    throw table.error(
        key, fmt::format("must be a whole multiple of {} = {}; nearest are {:.9g} and {:.9g}", part_key, part,
                         std::max(1.0, std::floor(count)) * part, (std::floor(count) + 1.0) * part));
  }
}

Grains read_grains(const CheckedTable& table) {
  const Grains grains{
      .diameter = table.number("diameter_m", {smallest_positive, 0.1}),
      .diameter_spread = table.number("diameter_spread", {0.0, 0.3}),
      .density = table.number("density_kg_m3", {100.0, 20000.0}),
      .youngs_modulus = table.number("youngs_modulus_pa", {1e5, 1e12}),
      .poissons_ratio = table.number("poissons_ratio", {0.0, 0.49}),
  };
  table.finish();
  return grains;
}

Geometry read_geometry(const CheckedTable& table, const Grains& grains) {
  const Geometry geometry{
      .column_length = table.number("column_length_m", {smallest_positive, 100.0}),
      .column_height = table.number("column_height_m", {smallest_positive, 100.0}),
      .thickness = table.number("thickness_m", {smallest_positive, 100.0}),
      .tank_length = table.number("tank_length_m", {smallest_positive, 1000.0}),
      .rough_floor = table.choice("floor", floors) == "rough",
  };
  table.finish();
  const double d = grains.diameter;
  if (geometry.column_length < 4.0 * d) {
    throw table.error("column_length_m", fmt::format("must be at least 4 grain diameters, {:.6g}", 4.0 * d));
  }
  if (geometry.column_height < 2.0 * d) {
    throw table.error("column_height_m", fmt::format("must be at least 2 grain diameters, {:.6g}", 2.0 * d));
  }
  // Thinner, a grain would touch its own periodic image's neighbours twice.
  if (geometry.thickness < 3.0 * d * (1.0 - 1e-9)) {
    throw table.error("thickness_m", fmt::format("must be at least 3 grain diameters, {:.6g}", 3.0 * d));
  }
  if (geometry.tank_length < geometry.column_length + 2.0 * d) {
    throw table.error("tank_length_m",
                      fmt::format("must leave room in front of the gate: more than column_length_m + 2 "
                                  "grain diameters, {:.6g}",
                                  geometry.column_length + 2.0 * d));
  }
  return geometry;
}

Contact read_contact(const CheckedTable& table) {
  const Contact contact{
      .restitution = table.number("restitution", {0.05, 1.0}),
      .friction = table.number("friction", {0.0, 2.0}),
      .rolling_friction = table.number("rolling_friction", {0.0, 2.0}),
      .wall_friction = table.number("wall_friction", {0.0, 2.0}),
  };
  table.finish();
  // Codes differ in which of two materials' friction they take at a contact; they agree where the wall is the smoother.
  if (contact.wall_friction > contact.friction) {
    throw table.error("wall_friction", fmt::format("must be at most friction = {}", contact.friction));
  }
  return contact;
}

Protocol read_protocol(const CheckedTable& table) {
  const Protocol protocol{
      .gravity = table.number("gravity_m_s2", {smallest_positive, 1000.0}),
      .volume_fraction = table.number("volume_fraction", {0.4, 0.7}),
      .settle_time = table.number("settle_time_s", {smallest_positive, 1000.0}),
      .run_time = table.number("run_time_s", {smallest_positive, 1000.0}),
      .snapshot_interval = table.number("snapshot_interval_s", {smallest_positive, 1000.0}),
      .time_step = table.number("time_step_s", {smallest_positive, 0.1}),
      .rest_energy = table.number("rest_energy", {smallest_positive, 0.01}),
  };
  table.finish();
  require_multiple(table, "settle_time_s", protocol.settle_time, "time_step_s", protocol.time_step);
  require_multiple(table, "snapshot_interval_s", protocol.snapshot_interval, "time_step_s",
                   protocol.time_step);
  require_multiple(table, "run_time_s", protocol.run_time, "snapshot_interval_s", protocol.snapshot_interval);
  return protocol;
}

/// What one machine can hold and run; far more than any case so far.
void check_size(const Case& column, const CheckedTable& grains, const CheckedTable& protocol) {
  constexpr double most_grains = 1e7, most_steps = 1e10, most_snapshots = 1e5;
  const Geometry& g = column.geometry;
  const double grain_volume = std::numbers::pi / 6.0 * std::pow(column.grains.diameter, 3);
  const double count =
      column.protocol.volume_fraction * g.column_length * g.column_height * g.thickness / grain_volume;
  if (!(count <= most_grains))
    throw grains.error("diameter_m", fmt::format("gives {:.3g} grains; at most {:.0g}", count, most_grains));
  const double steps = (column.protocol.settle_time + column.protocol.run_time) / column.protocol.time_step;
  if (!(steps <= most_steps))
    throw protocol.error("time_step_s", fmt::format("gives {:.3g} steps; at most {:.0g}", steps, most_steps));
  const double snapshots = column.protocol.run_time / column.protocol.snapshot_interval;
  if (!(snapshots <= most_snapshots)) {
    throw protocol.error("snapshot_interval_s",
                         fmt::format("gives {:.3g} snapshots; at most {:.0g}", snapshots, most_snapshots));
  }
}

std::vector<ObservableBand> read_observables(const CheckedTable& root) {
  std::vector<ObservableBand> bands;
  std::set<std::string> seen;
  for (const auto& table : root.tables("observable")) {
    bands.push_back({.name = table.choice("name", observables),
                     .relative_band = table.number("relative_band", {smallest_positive, 1.0}),
                     .why = table.string("why")});
    table.finish();
    if (!seen.insert(bands.back().name).second)
      throw table.error("name", "is given twice; give each observable once");
    if (bands.back().why.empty()) throw table.error("why", "must say where the band comes from");
  }
  return bands;
}

std::string read_name(const CheckedTable& root, std::string_view key) {
  std::string name = root.string(key);
  const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '_' || c == '-';
  });
  if (!plain) throw root.error(key, "must be letters, digits, '_' and '-': it names folders and tables");
  return name;
}

}  // namespace

Case read_case(const std::filesystem::path& file) {
  const auto root = CheckedTable::parse_file(file);
  root.require_schema(1);
  Case column;
  constexpr std::array<std::string_view, 1> kinds{
      "column_collapse"};  // what is released, and what is measured of it
  root.choice("kind", kinds);
  column.name = read_name(root, "name");
  column.title = root.string("title");
  column.calibration = read_name(root, "material");
  for (const auto seed : root.integers("seeds", 0, 1'000'000'000))
    column.seeds.push_back(static_cast<std::uint64_t>(seed));
  const auto grains = root.table("grains"), protocol = root.table("protocol");
  column.grains = read_grains(grains);
  column.geometry = read_geometry(root.table("geometry"), column.grains);
  column.contact = read_contact(root.table("contact"));
  column.protocol = read_protocol(protocol);
  check_size(column, grains, protocol);
  const auto ruler = root.table("ruler");
  const double d = column.grains.diameter;
  column.profile_bin = ruler.number("profile_bin_m", {0.25 * d, column.geometry.column_length});
  column.front_depth = ruler.number("front_depth_m", {0.1 * d, column.geometry.column_height});
  ruler.finish();
  column.observables = read_observables(root);
  root.finish();
  column.file = file;
  column.input_hash = sha256(read_file(file));
  return column;
}

}  // namespace talus::dem
