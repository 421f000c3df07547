#include "validation/backends/continuum_scene.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <optional>
#include <variant>
#include <vector>

#include "continuum/files/input_error.h"
#include "dem_cases/falling_sphere.h"

namespace talus::validation {
namespace {

using Eigen::Vector3d;

constexpr double degrees = 180.0 / std::numbers::pi;

/// A file's name may hold anything, and must not end the comment that it stands in.
std::string one_line(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return std::iscntrl(c) != 0; }, '?');
  return text;
}

std::string text_of(const Vector3d& v) {
  return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v[0], v[1], v[2]);
}

/// The nearest whole number of cells that reaches at least `length`.
double whole_cells(double length, double h) { return h * std::ceil(length / h - 1e-9); }

/// tan^-1 of a friction coefficient, in degrees, as scenes have it.
std::string friction(double coefficient) {
  return fmt::format("friction_angle_deg = {:.17g}", std::atan(coefficient) * degrees);
}

/// What a geometry is turned into.
struct Layout {
  Vector3d lower, upper;           // of the domain
  bool plane_strain;               // y periodic, one cell
  std::vector<std::string> sides;  // lines of [domain]
  std::vector<std::string> walls;  // tables [[wall]]
  std::string sand;                // shape of [[sand]]
  std::string bodies = {};         // tables [[body]]
};

std::string side(const char* name, const std::string& surface) {
  return fmt::format("{} = {{ kind = \"wall\", {} }}\n", name, surface);
}

std::string box(const Vector3d& lower, const Vector3d& upper) {
  return fmt::format("{{ kind = \"box\", lower_m = {}, upper_m = {} }}", text_of(lower), text_of(upper));
}

std::string wall(const std::string& shape, const std::string& surface) {
  return fmt::format("\n[[wall]]\nshape = {}\n{}\n", shape, surface);
}

std::string turned(const std::vector<Eigen::Vector2d>& corners, bool hollow) {
  std::string points;
  for (const auto& corner : corners)
    points += fmt::format("{}[{:.17g}, {:.17g}]", points.empty() ? "" : ", ", corner[0], corner[1]);
  return fmt::format(
      "{{ kind = \"profile\", base_m = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], points_m = [{}]{} }}", points,
      hollow ? ", hollow = true" : "");
}

std::string upright_cylinder(double radius, double height) {
  return fmt::format(
      "{{ kind = \"cylinder\", base_m = [0.0, 0.0, 0.0], axis = [0.0, 0.0, 1.0], radius_m = {:.17g}, "
      "height_m = {:.17g} }}",
      radius, height);
}

struct LayOut {
  double h;                // edge of the cells, m
  std::string smooth;      // the surface of walls, as scenes have it
  std::string flat_floor;  // that of flat floors
  std::string rough;       // that of floors of fixed grains
  double run_time;         // s
  std::string file;
  std::optional<dem::FallingSphere> sphere;

  Layout operator()(const dem::ColumnGeometry& g) const {
    if (!g.rough_floor) {
      throw InputError(fmt::format(
          "{}: key 'geometry.floor': the continuum knows the wall friction of a rough floor only; "
          "a flat floor's is not in the calibration",
          file));
    }
    return {.lower = Vector3d::Zero(),
            .upper = {whole_cells(g.tank_length, h), h, whole_cells(2.0 * g.column_height, h)},
            .plane_strain = true,
            .sides = {side("x_lower", smooth), side("x_upper", smooth), side("z_lower", rough)},
            .walls = {},
            .sand = box(Vector3d::Zero(), {g.column_length, h, g.column_height})};
  }

  Layout operator()(const dem::CylinderGeometry& g) const {
    const double half = whole_cells(0.5 * g.floor_side, h);
    return {.lower = {-half, -half, 0.0},
            .upper = {half, half, whole_cells(1.2 * g.height, h) + h},
            .plane_strain = false,
            .sides = {side("z_lower", rough)},
            .walls = {},
            .sand = upright_cylinder(g.radius, g.height)};
  }

  Layout operator()(const dem::HeapGeometry& g) const {
    const double half = whole_cells(0.5 * g.floor_side, h), top = whole_cells(g.height, h) + h;
    return {.lower = {-half, -half, 0.0},
            .upper = {half, half, top + whole_cells(g.lift_speed * run_time, h) + h},
            .plane_strain = false,
            .sides = {side("z_lower", rough)},
            .walls = {},
            .sand = upright_cylinder(g.radius, g.height),
            .bodies = tube(g, top)};
  }

  Layout operator()(const dem::SlotGeometry& g) const {
    const double thickness = 2.0 * h;  // of the bottom: what the grid sees
    const double left = 0.5 * (g.width - g.opening), right = 0.5 * (g.width + g.opening);
    return {.lower = {0.0, 0.0, -whole_cells(g.drop, h)},
            .upper = {g.width, h, whole_cells(g.height, h) + 2.0 * h},
            .plane_strain = true,
            .sides = {side("x_lower", smooth), side("x_upper", smooth), side("z_lower", flat_floor)},
            .walls = {wall(box({-h, -h, -thickness}, {left, 2.0 * h, 0.0}), rough),
                      wall(box({right, -h, -thickness}, {g.width + h, 2.0 * h, 0.0}), rough)},
            .sand = box(Vector3d::Zero(), {g.width, h, g.height})};
  }

  Layout operator()(const dem::LedgeGeometry& g) const {
    const double floor = -whole_cells(g.drop, h);
    return {.lower = {0.0, 0.0, floor},
            .upper = {whole_cells(g.tank_length, h), h, whole_cells(g.height, h) + 2.0 * h},
            .plane_strain = true,
            .sides = {side("x_lower", smooth), side("x_upper", smooth), side("z_lower", flat_floor)},
            .walls = {wall(box({-h, -h, floor - h}, {g.length, 2.0 * h, 0.0}), rough)},
            .sand = box(Vector3d::Zero(), {g.length, h, g.height})};
  }

  Layout operator()(const dem::ImpactGeometry& g) const {
    const double half = 0.5 * g.side;
    return {.lower = {-half, -half, 0.0},
            .upper = {half, half, whole_cells(sphere->room, h)},
            .plane_strain = false,
            .sides = {side("x_lower", smooth), side("x_upper", smooth), side("y_lower", smooth),
                      side("y_upper", smooth), side("z_lower", rough)},
            .walls = {},
            .sand = box({-half, -half, 0.0}, {half, half, g.height}),
            .bodies = ball(*sphere)};
  }

  Layout operator()(const dem::HourglassGeometry& g) const {
    const double half = whole_cells(g.bulb_radius, h) + h, top = whole_cells(g.height, h) + 2.0 * h;
    const std::vector<Eigen::Vector2d> glass{
        {0.0, -g.bulb_height},  {g.bulb_radius, -g.bulb_height}, {g.bulb_radius, -g.cone_height},
        {g.throat_radius, 0.0}, {g.bulb_radius, g.cone_height},  {g.bulb_radius, top + h},
        {0.0, top + h}};
    const std::vector<Eigen::Vector2d> fill{{0.0, 0.0},
                                            {g.throat_radius, 0.0},
                                            {g.bulb_radius, g.cone_height},
                                            {g.bulb_radius, g.height},
                                            {0.0, g.height}};
    return {.lower = {-half, -half, -whole_cells(g.bulb_height, h) - h},
            .upper = {half, half, top},
            .plane_strain = false,
            .sides = {},
            .walls = {wall(turned(glass, true), smooth)},
            .sand = turned(fill, false)};
  }

 private:
  /// None of its contacts carries more than the contacts' own friction, and so the whole surface does not either.
  std::string ball(const dem::FallingSphere& s) const {
    return fmt::format(
        "\n[[body]]\nname = \"ball\"\nshape = {{ kind = \"sphere\", centre_m = {}, radius_m = {:.17g} }}\n"
        "density_kg_m3 = {:.17g}\nvelocity_m_s = {}\n{}\n",
        text_of(s.centre), s.radius, s.density, text_of({0.0, 0.0, -s.speed}), flat_floor);
  }

  /// Rises as it is told, so that its density does not matter. The discrete codes' has no thickness.
  std::string tube(const dem::HeapGeometry& g, double top) const {
    const double outer = g.radius + 2.0 * h;  // what the grid sees
    return fmt::format(
        "\n[[body]]\nname = \"tube\"\nshape = {}\ndensity_kg_m3 = 1000.0\n"
        "motion = {{ kind = \"prescribed\", velocity_m_s = {} }}\n{}\n",
        turned({{g.radius, 0.0}, {outer, 0.0}, {outer, top}, {g.radius, top}}, false),
        text_of({0.0, 0.0, g.lift_speed}), smooth);
  }
};

/// [[material]] with the friction law of the calibration.
std::string material_text(const dem::Case& a_case, const dem::MaterialConstants& material, double factor) {
  const double slow = material.friction_law ? material.friction_law->mu_1 : std::sin(material.friction_angle);
  std::string text = fmt::format(
      "\n[[material]]\nname = \"sand\"\ngrain_density_kg_m3 = {:.17g}\nmax_volume_fraction = {:.17g}\n{}\n",
      a_case.grains.density, material.max_volume_fraction, friction(factor * slow));
  if (material.friction_law) {
    text += fmt::format(
        "rate_dependence = {{ fast_{}, inertial_number = {:.17g}, grain_diameter_m = {:.17g} }}\n",
        friction(factor * material.friction_law->mu_2), material.friction_law->I_0, a_case.grains.diameter);
  }
  return text;
}

/// A continuum drains faster than grains, which lose the width of an opening's edges: its rate needs more snapshots.
double frame_interval(const dem::Case& a_case) {
  const bool drains = a_case.kind == "slot" || a_case.kind == "hourglass";
  return (drains ? 0.5 : 1.0) * a_case.protocol.snapshot_interval;
}

Layout layout_of(const dem::Case& a_case, double h, const Defects& defects) {
  const double factor = defects.walls_have_friction ? 1.0 : 0.0;
  return std::visit(
      LayOut{h, friction(factor * a_case.contact.wall_friction), friction(factor * a_case.contact.friction),
             defects.walls_have_friction ? "rough = true" : friction(0.0), a_case.protocol.run_time,
             a_case.file.string(), dem::falling_sphere(a_case)},
      a_case.geometry);
}

/// Particles at the start and steps of the run, roughly.
struct Size {
  double particles, steps;
};

Size size_of(const dem::Case& a_case, const ContinuumResolution& resolution) {
  const double h = cell_size(a_case, resolution.cells), g = a_case.protocol.gravity;
  const double thickness = dem::periodic_thickness(a_case.geometry);
  const double volume = dem::fill_volume(a_case.geometry) * (thickness > 0.0 ? h / thickness : 1.0);
  double fastest = std::sqrt(2.0 * g * dem::fill_height(a_case.geometry));
  if (const auto* impact = std::get_if<dem::ImpactGeometry>(&a_case.geometry)) fastest = impact->impact_speed;
  const double step = resolution.courant_factor * std::min(0.25 * std::sqrt(h / g), 0.4 * h / fastest);
  return {volume / std::pow(h, 3) * std::pow(resolution.particles_per_cell_axis, 3),
          a_case.protocol.run_time / step};
}

}  // namespace

double cell_length(const dem::Case& a_case) {
  struct Length {
    double operator()(const dem::ColumnGeometry& g) const { return g.column_length; }
    double operator()(const dem::CylinderGeometry& g) const { return g.radius; }
    double operator()(const dem::HeapGeometry& g) const { return g.radius; }
    double operator()(const dem::SlotGeometry& g) const { return g.opening; }
    double operator()(const dem::HourglassGeometry& g) const { return 2.0 * g.throat_radius; }
    double operator()(const dem::LedgeGeometry& g) const { return g.length; }
    double operator()(const dem::ImpactGeometry& g) const { return g.sphere_diameter; }
  };
  return std::visit(Length{}, a_case.geometry);
}

double cell_size(const dem::Case& a_case, int cells) {
  const double h = cell_length(a_case) / cells;
  if (const auto* slot = std::get_if<dem::SlotGeometry>(&a_case.geometry))
    return slot->width / std::round(slot->width / h);
  if (const auto* impact = std::get_if<dem::ImpactGeometry>(&a_case.geometry))
    return impact->side / std::round(impact->side / h);
  return h;
}

std::string continuum_scene(const dem::Case& a_case, const dem::MaterialConstants& material,
                            const ContinuumResolution& resolution, std::uint64_t seed,
                            const Defects& defects) {
  const double h = cell_size(a_case, resolution.cells);
  const Layout layout = layout_of(a_case, h, defects);
  const dem::Protocol& protocol = a_case.protocol;
  std::string text = fmt::format(
      "# Written from {} ({}), seed {}, by talus-validate.\nschema = 1\n\n[domain]\norigin_m = {}\nsize_m = "
      "{}\n"
      "cell_size_m = {:.17g}\ngravity_m_s2 = [0.0, 0.0, {:.17g}]\n",
      one_line(a_case.file.filename().string()), a_case.point, seed, text_of(layout.lower),
      text_of(layout.upper - layout.lower), h, -defects.gravity_factor * protocol.gravity);
  if (layout.plane_strain) text += "periodic = [\"y\"]\n";
  for (const auto& line : layout.sides) text += line;
  text += material_text(a_case, material, defects.friction_factor);
  for (const auto& table : layout.walls) text += table;
  text += layout.bodies;
  text += fmt::format(
      "\n[[sand]]\nmaterial = \"sand\"\nshape = {}\n\n[particles]\nper_cell_axis = {}\njitter = "
      "{:.17g}\nseed = {}\n\n"
      "[time]\nend_s = {:.17g}\nframe_interval_s = {:.17g}\n",
      layout.sand, resolution.particles_per_cell_axis, resolution.lattice_jitter, seed, protocol.run_time,
      frame_interval(a_case));
  if (resolution.courant_factor != 1.0 || !defects.solver.empty()) text += "\n[solver]\n";
  if (resolution.courant_factor != 1.0)
    text += fmt::format("courant_factor = {:.17g}\n", resolution.courant_factor);
  if (!defects.solver.empty()) text += fmt::format("broken = \"{}\"\n", defects.solver);
  return text;
}

double expected_continuum_cpu(const dem::Case& a_case, const ContinuumResolution& resolution) {
  // What falls freely scatters over many cells, and costs more.
  const double seconds_per_particle_step = a_case.kind.ends_with("collapse") ? 1e-6 : 4e-6;
  const Size size = size_of(a_case, resolution);
  return 0.5 + size.particles * size.steps * seconds_per_particle_step;
}

double expected_continuum_memory(const dem::Case& a_case, const ContinuumResolution& resolution) {
  constexpr double base = 50.0, per_particle = 1e-3;  // MB
  return base + per_particle * size_of(a_case, resolution).particles;
}

}  // namespace talus::validation
