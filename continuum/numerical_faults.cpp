#include "continuum/numerical_faults.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "continuum/stress/friction_fields.h"

namespace talus {
namespace {

std::string text_of(const Eigen::Vector3d& at) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g}) m", at[0], at[1], at[2]);
}

[[noreturn]] void fail(std::string_view quantity, std::string_view place, double time) {
  throw NumericalError(fmt::format("{} at t = {:.6g} s, {}", quantity, time, place));
}

Eigen::Vector3d centre_of_cell(const ActiveRegion& region, int cell) {
  const Eigen::Vector3i at = region.grid.cell_of_index(region.dense_of_cell[static_cast<std::size_t>(cell)]);
  return region.grid.origin + region.grid.spacing * (at.cast<double>().array() + 0.5).matrix();
}

/// The middle of a face that lies on the lower or the upper side of a cell.
Eigen::Vector3d beside(const ActiveRegion& region, int cell, int axis, bool lower) {
  return centre_of_cell(region, cell) +
         (lower ? -0.5 : 0.5) * region.grid.spacing * Eigen::Vector3d::Unit(axis);
}

struct Face {
  int axis;
  Eigen::Vector3d centre;
};

Face face_at(const ActiveRegion& region, int face) {
  if (face < region.open_faces) {
    const auto f = static_cast<std::size_t>(face);
    const auto [below, above] = region.face_cells[f];
    const int axis = region.face_axis[f];
    const bool has_above = above >= 0 && above < region.cell_count();
    return {axis, beside(region, has_above ? above : below, axis, has_above)};
  }
  const WallFace& wall = region.wall_faces[static_cast<std::size_t>(face - region.open_faces - 1)];
  return {wall.axis, beside(region, wall.cell, wall.axis, wall.inward > 0.0)};
}

}  // namespace

void require_sound(const Grid& grid, const Particles& particles, double time) {
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    const auto refuse = [&](std::string_view quantity, std::string_view why = "is not finite") {
      fail(fmt::format("{} of particle {} {}", quantity, p, why),
           fmt::format("at {}", text_of(particles.positions.col(p))), time);
    };
    if (!particles.velocities.col(p).allFinite()) refuse("the velocity");
    if (!grid.contains(particles.positions.col(p))) refuse("the position", "is not one in the domain");
    if (!(particles.masses[p] > 0.0) || !std::isfinite(particles.masses[p]))
      refuse("the mass", "is not positive and finite");
    if (!particles.shapes.col(p).allFinite()) refuse("the shape");
    if (particles.has_gradients() && !particles.gradients.col(p).allFinite()) refuse("the velocity gradient");
  }
}

void require_finite_positions(const Particles& particles, std::string_view after, double time) {
  if (particles.positions.allFinite()) return;
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    if (!particles.positions.col(p).allFinite())
      fail(fmt::format("the position of particle {} is not finite after {}", p, after),
           fmt::format("mass {:.6g} kg", particles.masses[p]), time);
  }
}

void require_sound(std::span<const Body> bodies, double time) {
  for (const Body& body : bodies) {
    const auto refuse = [&](std::string_view quantity) {
      fail(fmt::format("{} of body '{}' is not finite", quantity, body.name),
           fmt::format("at {}", text_of(body.pose.position)), time);
    };
    if (!body.twist.velocity.allFinite() || !body.twist.angular_velocity.allFinite()) refuse("the velocity");
    if (!body.pose.position.allFinite() || !body.pose.orientation.coeffs().allFinite()) refuse("the pose");
  }
}

void require_finite(const ActiveRegion& region, const SchemeStress& stress, double time) {
  const Field& pressure = pressure_of(stress);
  for (int cell = 0; cell < region.cell_count(); ++cell) {
    if (!std::isfinite(pressure[cell]))
      fail("the pressure that the last step left is not finite",
           fmt::format("in the cell about {}", text_of(centre_of_cell(region, cell))), time);
  }
  const auto refuse = [&] {
    fail("the friction stress that the last step left is not finite", "somewhere in the sand", time);
  };
  if (const auto* paper = std::get_if<PaperStress>(&stress)) {
    const StressField& friction = paper->friction;
    if (!friction.diagonal.allFinite() || !friction.shear.allFinite() || !friction.contact.allFinite())
      refuse();
    return;
  }
  const Eigen::ArrayXd& copies = std::get<Stress>(stress).copies;
  if (copies.allFinite()) return;
  for (int cell = 0; cell < region.cell_count(); ++cell) {
    if (!copies.segment(values_per_cell * cell, values_per_cell).allFinite())
      fail("the friction stress that the last step left is not finite",
           fmt::format("in the cell about {}", text_of(centre_of_cell(region, cell))), time);
  }
  refuse();
}

void require_finite(const ActiveRegion& region, const Field& velocity, double time, double dt) {
  if (velocity.isFinite().all()) return;
  for (int face = 0; face < region.face_count(); ++face) {
    if (std::isfinite(velocity[face]) || face == region.null_face()) continue;
    constexpr std::array<std::string_view, 3> axes{"x", "y", "z"};
    const Face at = face_at(region, face);
    fail(fmt::format("the sand's velocity along {} is not finite", axes[static_cast<std::size_t>(at.axis)]),
         fmt::format("dt = {:.3g} s, on the face about {}", dt, text_of(at.centre)), time);
  }
  fail("the sand's velocity is not finite", "where no face is", time);
}

}  // namespace talus
