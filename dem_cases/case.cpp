#include "dem_cases/case.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string_view>
#include <utility>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "continuum/files/faults.h"
#include "continuum/files/provenance.h"
#include "dem_cases/falling_sphere.h"
#include "dem_cases/read_geometry.h"

namespace talus::dem {
namespace {

constexpr std::array<std::string_view, 7> kinds{
    "column_collapse", "cylinder_collapse", "heap", "slot", "hourglass", "ledge", "impact"};

/// What can be measured of each kind (measure.h).
std::vector<std::string_view> observables_of(std::string_view kind) {
  if (kind == "column_collapse")
    return {"runout", "x90", "x95", "centre_of_mass", "final_height", "stop_time", "profile_L1"};
  if (kind == "cylinder_collapse")
    return {"runout", "r90", "r95", "mean_radius", "final_height", "stop_time", "profile_L1"};
  if (kind == "slot" || kind == "hourglass") return {"discharge_rate", "beverloo_C"};
  if (kind == "impact") return {"penetration_depth", "stop_time", "depth_curve_L1"};
  return {"repose_angle", "profile_L1"};
}

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
  const double count =
      expected_grains(column) + floor_area(column.geometry) / std::pow(column.grains.diameter, 2);
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

std::vector<ObservableBand> read_observables(const CheckedTable& root, std::string_view kind) {
  const auto observables = observables_of(kind);
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

bool names_a_folder(std::string_view name) {
  constexpr std::size_t longest = 100;
  return !name.empty() && name.size() <= longest && name.front() != '.' &&
         std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-' || c == '.'; });
}

constexpr std::string_view plain_name =
    "must be letters, digits, '_', '-' and '.', at most 100: it names folders and tables";

}  // namespace

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

std::string read_folder_name(const CheckedTable& root, std::string_view key) {
  std::string name = root.string(key);
  if (!names_a_folder(name)) throw root.error(key, plain_name);
  return name;
}

namespace {

Ruler read_ruler(const CheckedTable& table, const Case& a_case) {
  const double d = a_case.grains.diameter, height = fill_height(a_case.geometry);
  Ruler ruler{};
  ruler.profile_bin = table.number("profile_bin_m", {0.25 * d, height});
  if (a_case.kind.ends_with("collapse")) ruler.front_depth = table.number("front_depth_m", {0.1 * d, height});
  if (a_case.kind == "slot" || a_case.kind == "hourglass") {
    ruler.window_upper = table.number("window_upper", {0.1, 1.0});
    ruler.window_lower = table.number("window_lower", {0.0, ruler.window_upper - 0.05});
  }
  table.finish();
  return ruler;
}

std::vector<std::uint64_t> read_seeds(const CheckedTable& table, std::string_view key,
                                      bool may_be_empty = false) {
  std::vector<std::uint64_t> seeds;
  for (const auto seed : table.integers(key, 0, 1'000'000'000, may_be_empty))
    seeds.push_back(static_cast<std::uint64_t>(seed));
  return seeds;
}

}  // namespace

double expected_grains(const Case& a_case) {
  const double grain_volume = std::numbers::pi / 6.0 * std::pow(a_case.grains.diameter, 3);
  return a_case.protocol.volume_fraction * fill_volume(a_case.geometry) / grain_volume;
}

const ColumnGeometry& column_geometry(const Case& column) {
  if (const auto* geometry = std::get_if<ColumnGeometry>(&column.geometry)) return *geometry;
  throw InputError(
      fmt::format("{}: is a {}; a column_collapse is needed here", column.file.string(), column.kind));
}

ColumnGeometry& column_geometry(Case& column) {
  return const_cast<ColumnGeometry&>(column_geometry(std::as_const(column)));
}

/// The tube must come clear of the heap.
static void check_lift(const HeapGeometry& heap, const Protocol& protocol, const CheckedTable& table) {
  if (heap.lift_speed * protocol.run_time < heap.height) {
    throw table.error("lift_speed_m_s",
                      fmt::format("lifts the tube by {:.4g} m in protocol.run_time_s; it must be at least "
                                  "height_m = {}, or the tube still holds the heap",
                                  heap.lift_speed * protocol.run_time, heap.height));
  }
}

/// The sphere starts above the bed, so it must be faster at the bed than it gets by falling from there.
static void check_fall(const ImpactGeometry& impact, const Case& a_case, const CheckedTable& table) {
  const double slowest = std::sqrt(2.0 * a_case.protocol.gravity * start_clearance * a_case.grains.diameter);
  if (!(impact.impact_speed > slowest)) {
    throw table.error(
        "impact_speed_m_s",
        fmt::format("must be more than {:.4g}: the sphere starts {} grain diameters above the bed", slowest,
                    start_clearance));
  }
}

namespace {

/// Of whom and of what; nothing of the rest hangs on it.
void read_head(const CheckedTable& root, std::string_view point, Case& a_case) {
  a_case.name = read_folder_name(root, "name");
  const std::string own_point = read_folder_name(root, "base_point");
  a_case.point = point.empty() ? own_point : std::string(point);
  a_case.title = root.string("title");
  a_case.calibration = read_folder_name(root, "material");
  a_case.seeds = read_seeds(root, "seeds");
}

void read_reference_seeds(const CheckedTable& root, Case& a_case) {
  const auto reference = root.optional_table("reference");
  if (!reference) return;
  for (const std::string code : {"liggghts", "yade"}) {
    if (reference->has(code + "_seeds"))
      a_case.reference_seeds[code] = read_seeds(*reference, code + "_seeds", true);
  }
  reference->finish();
}

/// All tables, and whether they go together.
void read_tables(const CheckedTable& root, Faults& faults, Case& a_case) {
  const auto read = [&](auto reader) { return passes(faults, reader); };
  const bool grains = read([&] { a_case.grains = read_grains(root.table("grains")); });
  const bool protocol = read([&] { a_case.protocol = read_protocol(root.table("protocol")); });
  read([&] { a_case.contact = read_contact(root.table("contact")); });
  read([&] { a_case.observables = read_observables(root, a_case.kind); });
  const bool geometry = grains && read([&] {
                          a_case.geometry = read_geometry(root.table("geometry"), a_case.kind, a_case.grains);
                        });
  if (geometry) read([&] { a_case.ruler = read_ruler(root.table("ruler"), a_case); });
  if (!geometry || !protocol) return;
  read([&] {
    if (const auto* heap = std::get_if<HeapGeometry>(&a_case.geometry))
      check_lift(*heap, a_case.protocol, root.table("geometry"));
    if (const auto* impact = std::get_if<ImpactGeometry>(&a_case.geometry))
      check_fall(*impact, a_case, root.table("geometry"));
    check_size(a_case, root.table("grains"), root.table("protocol"));
  });
}

}  // namespace

Case read_case(const std::filesystem::path& file, std::string_view point) {
  if (!point.empty() && !names_a_folder(point))
    throw InputError(fmt::format("{}: point.name = {:?} {}", file.string(), point, plain_name));
  const auto root = CheckedTable::parse_point(file, point);
  root.require_schema(1);
  Case a_case;
  a_case.kind = root.choice("kind", kinds);
  for (const char* table : {"grains", "geometry", "contact", "protocol", "ruler", "observable", "reference"})
    root.has(table);
  Faults faults;
  passes(faults, [&] { read_head(root, point, a_case); });
  passes(faults, [&] { read_reference_seeds(root, a_case); });
  read_tables(root, faults, a_case);
  if (faults.empty()) passes(faults, [&] { root.finish(); });
  refuse(faults);
  a_case.file = file;
  a_case.input_hash = sha256(read_file(file));
  return a_case;
}

std::vector<Case> read_case_points(const std::filesystem::path& file) {
  std::vector<Case> points{read_case(file)};
  for (const auto& name : CheckedTable::point_names(file)) {
    if (name.empty()) throw InputError(fmt::format("{}: point.name = \"\" {}", file.string(), plain_name));
    points.push_back(read_case(file, name));
    if (name == points.front().point) {
      throw InputError(
          fmt::format("{}: the point '{}' has the name of the file's own, base_point; give it another",
                      file.string(), name));
    }
  }
  return points;
}

}  // namespace talus::dem
