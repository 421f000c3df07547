#include "continuum/scene/read_bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "continuum/scene/read_common.h"
#include "continuum/scene/read_shape.h"
#include "continuum/solids/body_images.h"
#include "continuum/solids/mass_properties.h"

namespace talus {
namespace {

constexpr std::size_t longest_name = 100;
constexpr double usual_contact_friction = 0.5;
constexpr double most_contact_friction = 10.0;
constexpr double least_thickness_given = 0.25;  // cells; thinner ones would be swollen out of all likeness
constexpr double overlap_allowed = 0.01;        // of an inradius: files have few digits

std::string read_name(const CheckedTable& table, const std::vector<Body>& bodies) {
  std::string name = table.string("name");
  const bool plain = !name.empty() && name.size() <= longest_name &&
                     std::all_of(name.begin(), name.end(),
                                 [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; });
  if (!plain)
    throw table.error(
        "name", fmt::format("must be letters, digits, - and _, at most {}: it names a file", longest_name));
  if (std::any_of(bodies.begin(), bodies.end(), [&](const Body& other) { return other.name == name; }))
    throw table.error("name", "is there twice");
  return name;
}

Eigen::Vector3d vector_or_zero(const CheckedTable& table, std::string_view key, Range allowed) {
  return table.has(key) ? table.vector(key, allowed) : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

Hinge read_hinge(const CheckedTable& motion) {
  Hinge hinge;
  hinge.pivot = motion.vector("pivot_m", coordinate_range);
  const Eigen::Vector3d axis = motion.vector("axis");
  if (!std::isnormal(axis.stableNorm())) throw motion.error("axis", "must be a direction, such as [0, 0, 1]");
  hinge.axis = axis.stableNormalized();
  hinge.torque = motion.number("torque_n_m", torque_range, 0.0);
  return hinge;
}

Prescribed read_prescribed(const CheckedTable& motion) {
  Prescribed prescribed{{vector_or_zero(motion, "velocity_m_s", velocity_range),
                         vector_or_zero(motion, "angular_velocity_rad_s", rotation_range)}};
  prescribed.start = motion.number("start_s", non_negative, prescribed.start);
  prescribed.end = motion.number("end_s", positive, prescribed.end);
  if (prescribed.end <= prescribed.start) throw motion.error("end_s", "must come after start_s");
  return prescribed;
}

BodyMotion read_motion(const CheckedTable& table) {
  constexpr std::array<std::string_view, 3> kinds{"free", "hinge", "prescribed"};
  const auto given = table.optional_table("motion");
  if (!given) return Free{};
  const std::string kind = given->choice("kind", kinds);
  BodyMotion motion = Free{};
  if (kind == "hinge") motion = read_hinge(*given);
  if (kind == "prescribed") motion = read_prescribed(*given);
  given->finish();
  return motion;
}

/// At the start; a hinge or a prescribed motion leaves less to choose.
Twist read_twist(const CheckedTable& table, const BodyMotion& motion) {
  const bool prescribed = std::holds_alternative<Prescribed>(motion);
  const auto* const hinge = std::get_if<Hinge>(&motion);
  if (table.has("velocity_m_s") && prescribed)
    throw table.error("velocity_m_s", "is prescribed in motion; remove this");
  if (table.has("velocity_m_s") && hinge)
    throw table.error("velocity_m_s", "follows from the hinge; give angular_velocity_rad_s");
  if (table.has("angular_velocity_rad_s") && prescribed)
    throw table.error("angular_velocity_rad_s", "is prescribed in motion; remove this");
  Twist twist{vector_or_zero(table, "velocity_m_s", velocity_range),
              vector_or_zero(table, "angular_velocity_rad_s", rotation_range)};
  const Eigen::Vector3d& turning = twist.angular_velocity;
  if (hinge && hinge->axis.cross(turning).norm() > 1e-9 * turning.norm())
    throw table.error("angular_velocity_rad_s", "must be along the axis of the hinge");
  return twist;
}

/// Over the ends of a periodic axis a body may reach.
bool fits(const Grid& grid, const Eigen::AlignedBox3d& box) {
  Eigen::AlignedBox3d within = box;
  for (int axis = 0; axis < 3; ++axis) {
    if (!grid.periodic[static_cast<std::size_t>(axis)]) continue;
    within.min()[axis] = grid.origin[axis];
    within.max()[axis] = grid.origin[axis] + box.sizes()[axis];
  }
  return holds(grid, within);
}

Shape read_body_shape(const CheckedTable& table, const Grid& grid) {
  Shape shape = read_shape(table.table("shape"));
  if (const auto fault = body_fault(shape)) throw table.error("shape", *fault);
  if (!fits(grid, bounds(shape))) {
    throw table.error(
        "shape", "must lie inside the domain; along a periodic axis it must be no longer than the domain");
  }
  return shape;
}

Body read_body(const CheckedTable& table, const std::vector<Body>& earlier, const Grid& grid) {
  const std::string name = read_name(table, earlier);
  const Shape shape = read_body_shape(table, grid);
  const double density = table.number("density_kg_m3", solid_density_range);
  const BodyMotion motion = read_motion(table);
  Body body = make_body(name, shape, density, motion, read_twist(table, motion));
  body.friction = read_solid_friction(table);
  body.contact_friction =
      table.number("contact_friction", {0.0, most_contact_friction}, usual_contact_friction);
  body.restitution = table.number("restitution", {0.0, 1.0}, 0.0);
  table.finish();
  const double thickness = 2.0 * inradius(body.shape);
  if (thickness < least_thickness_given * grid.spacing) {
    throw table.error("shape", fmt::format("is {:.3g} m thick; must be at least {} of cell_size_m = {}",
                                           thickness, least_thickness_given, grid.spacing));
  }
  return body;
}

/// Overlaps in the surface, and what lies in something whole.
void check_overlaps(const std::vector<CheckedTable>& tables, const std::vector<Body>& bodies,
                    const BodySurroundings& surroundings) {
  const auto refuse_wall = [&](std::size_t i) {
    throw tables[i].error("shape", "must not lie in a [[wall]] or a wall of the domain");
  };
  const auto refuse_body = [&](std::size_t i, std::size_t other) {
    throw tables[i].error("shape", fmt::format("must not overlap body '{}'", bodies[other].name));
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Eigen::Vector3d centre = surroundings.grid.wrapped_position(bodies[i].pose.position);
    const bool prescribed = std::holds_alternative<Prescribed>(bodies[i].motion);
    const double inside = -0.5 * inradius(bodies[i].shape);
    if (!prescribed && nearest_wall(surroundings.walls, 0.0, centre).distance < inside) refuse_wall(i);
    for (std::size_t j = 0; j < bodies.size(); ++j) {
      if (j == i) continue;
      const Eigen::Vector3d image = nearest_image(surroundings.grid, centre, bounds(bodies[j]).center());
      if (signed_distance(bodies[j], image) < inside) refuse_body(std::max(i, j), std::min(i, j));
    }
  }
  for (const ContactPoint& contact : ContactFinder(bodies, surroundings).find(bodies, 0.0)) {
    const auto first = static_cast<std::size_t>(contact.first);
    double allowed = overlap_allowed * inradius(bodies[first].shape);
    if (contact.second == no_body) {
      if (contact.depth > allowed) refuse_wall(first);
      continue;
    }
    const auto second = static_cast<std::size_t>(contact.second);
    allowed = std::min(allowed, overlap_allowed * inradius(bodies[second].shape));
    if (contact.depth > allowed) refuse_body(std::max(first, second), std::min(first, second));
  }
}

}  // namespace

std::vector<Body> read_bodies(const CheckedTable& root, const BodySurroundings& surroundings) {
  std::vector<Body> bodies;
  const std::vector<CheckedTable> tables = up_to_most_tables(root, "body");
  for (const CheckedTable& table : tables) bodies.push_back(read_body(table, bodies, surroundings.grid));
  check_overlaps(tables, bodies, surroundings);
  return bodies;
}

}  // namespace talus
