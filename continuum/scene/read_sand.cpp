#include "continuum/scene/read_sand.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "continuum/scene/read_common.h"
#include "continuum/scene/read_shape.h"

namespace talus {
namespace {

constexpr Range grain_density_range{100.0, 30000.0};  // kg/m^3: from foamed polymers to osmium
constexpr Range inertial_number_range{1e-6, 100.0};   // at which friction is half way to its fast value
constexpr Range grain_diameter_range{1e-7, 10.0};     // m

RateDependence read_rate(const CheckedTable& rate, double slowest) {
  RateDependence dependence;
  dependence.fast_friction =
      friction_of_angle_deg(rate.number("fast_friction_angle_deg", {slowest, largest_friction_angle_deg}));
  dependence.inertial_number = rate.number("inertial_number", inertial_number_range);
  dependence.grain_diameter = rate.number("grain_diameter_m", grain_diameter_range);
  rate.finish();
  return dependence;
}

Material read_material(const CheckedTable& table, const std::vector<Material>& earlier) {
  Material material{};
  material.name = table.string("name");
  material.grain_density = table.number("grain_density_kg_m3", grain_density_range);
  material.max_volume_fraction = table.number("max_volume_fraction", {0.1, 0.8});
  const double slowest = table.number("friction_angle_deg", {0.0, largest_friction_angle_deg});
  material.friction = friction_of_angle_deg(slowest);
  if (const auto rate = table.optional_table("rate_dependence")) material.rate = read_rate(*rate, slowest);
  table.finish();
  const auto same = [&](const Material& other) { return other.name == material.name; };
  if (std::any_of(earlier.begin(), earlier.end(), same)) throw table.error("name", "is there twice");
  return material;
}

std::size_t read_material_name(const CheckedTable& table, const std::vector<Material>& materials) {
  std::vector<std::string_view> names;
  for (const Material& material : materials) names.push_back(material.name);
  const std::string name = table.choice("material", names);
  return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
}

Filling read_filling(const CheckedTable& table, const Scene& scene) {
  Filling filling{read_material_name(table, scene.materials), read_shape(table.table("shape"))};
  if (!holds(scene.grid, bounds(filling.shape))) throw table.error("shape", "must lie inside the domain");
  if (table.has("velocity_m_s")) filling.velocity = table.vector("velocity_m_s", velocity_range);
  table.finish();
  return filling;
}

Source read_source(const CheckedTable& table, const Scene& scene) {
  constexpr std::array<std::string_view, 2> outlines{"rectangle", "ellipse"};
  Source source{};
  source.material = static_cast<int>(read_material_name(table, scene.materials));
  source.lower = table.vector("lower_m", coordinate_range);
  source.upper = table.vector("upper_m", coordinate_range);
  if (((source.upper - source.lower).array() == 0.0).count() != 1 ||
      (source.upper.array() < source.lower.array()).any())
    throw table.error(
        "upper_m",
        "must equal lower_m along one axis, the inlet's normal, and lie above it along the others");
  if (!holds(scene.grid, {source.lower, source.upper}))
    throw table.error("upper_m", "the inlet must lie inside the domain");
  source.round = table.choice("outline", outlines) == "ellipse";
  source.velocity = table.vector("velocity_m_s", velocity_range);
  if (source.velocity[source.normal()] == 0.0)
    throw table.error("velocity_m_s", "must not be 0 along the inlet's normal");
  source.fill = table.number("fill", {0.01, 1.0}, 1.0);
  source.start = table.number("start_s", non_negative, 0.0);
  source.end = table.number("end_s", positive, std::numeric_limits<double>::infinity());
  if (source.end <= source.start) throw table.error("end_s", "must come after start_s");
  source.spacing = scene.grid.spacing / scene.particles_per_cell.maxCoeff();
  if (!std::isfinite(source.next_layer_time()))
    throw table.error("end_s", "comes before the first layer of sand has entered");
  for (const Eigen::Vector3d& corner :
       {source.lower, source.upper, Eigen::Vector3d(0.5 * (source.lower + source.upper))}) {
    if (nearest_wall(scene.walls, source.start, corner).distance < -1e-9 * scene.grid.spacing)
      throw table.error("upper_m", "the inlet must not lie inside a [[wall]]");
  }
  table.finish();
  return source;
}

/// Reads each of the tables [[key]] that can be read; returns whether these are all.
template <class Read>
bool read_each(const CheckedTable& root, std::string_view key, Faults& faults, Read read) {
  bool all = true;
  const bool there = passes(faults, [&] {
    for (const auto& table : up_to_most_tables(root, key)) all = passes(faults, [&] { read(table); }) && all;
  });
  return all && there;
}

}  // namespace

void read_materials(const CheckedTable& root, Scene& scene) {
  for (const auto& table : root.tables("material"))
    scene.materials.push_back(read_material(table, scene.materials));
}

bool read_fillings(const CheckedTable& root, Faults& faults, Scene& scene) {
  return read_each(root, "sand", faults,
                   [&](const CheckedTable& table) { scene.fillings.push_back(read_filling(table, scene)); });
}

bool read_sources(const CheckedTable& root, Faults& faults, Scene& scene) {
  return read_each(root, "source", faults,
                   [&](const CheckedTable& table) { scene.sources.push_back(read_source(table, scene)); });
}

}  // namespace talus
