#include "continuum/scene/cost.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "continuum/solids/mass_properties.h"

namespace talus {
namespace {

// Peaks of resident memory (/usr/bin/time -f %M), rounded up: `talus run` of one frame and, of 306,000 and 824,000 particles,
// tests/continuum/bench/README.md. A particle is counted with the cells that it makes active and the solver's rows of them: 650
// bytes of 59,000 particles, 840 of 306,000, 1020 of 824,000. Of 4e6 cells without walls only those near sand are touched; with
// walls all are, with 114 bytes each. A render point: 13 to 20 bytes.
constexpr double bytes_of_program = 2.5e7;
constexpr double bytes_per_cell = 60.0;         // as if sand came everywhere
constexpr double bytes_per_cell_beside = 60.0;  // more, where there are walls or bodies
constexpr double bytes_per_particle = 1100.0;
constexpr double bytes_per_render_point = 40.0;

/// Along gravity, from the highest sand to the lowest end of the domain, m.
double longest_fall(const Scene& scene) {
  const double g = scene.gravity.norm();
  if (!(g > 0.0)) return 0.0;
  const Eigen::Vector3d down = scene.gravity / g;
  const auto reach = [&](const Eigen::AlignedBox3d& box, bool deepest) {
    const Eigen::Vector3d corner = ((down.array() > 0.0) == deepest).select(box.max(), box.min());
    return down.dot(corner);
  };
  const double bottom = reach({scene.grid.origin, scene.grid.upper()}, true);
  double top = bottom;
  for (const Filling& filling : scene.fillings) top = std::min(top, reach(bounds(filling.shape), false));
  for (const Source& source : scene.sources) top = std::min(top, reach({source.lower, source.upper}, false));
  for (const Body& body : scene.bodies) top = std::min(top, reach(bounds(body), false));
  return bottom - top;
}

/// m/s, by what the scene says and by falling.
double fastest(const Scene& scene) {
  double speed = 0.0;
  for (const Filling& filling : scene.fillings) speed = std::max(speed, filling.velocity.norm());
  for (const Source& source : scene.sources) speed = std::max(speed, source.velocity.norm());
  for (const Explosion& explosion : scene.explosions) speed = std::max(speed, explosion.speed);
  for (const Body& body : scene.bodies)
    speed =
        std::max(speed, body.twist.velocity.norm() + body.twist.angular_velocity.norm() * outer_radius(body));
  return std::hypot(speed, std::sqrt(2.0 * scene.gravity.norm() * longest_fall(scene)));
}

double sent_by(const Source& source, const Scene& scene) {
  Eigen::Vector3d sides = source.upper - source.lower;
  sides[source.normal()] = 1.0;
  const double area = sides.prod() * (source.round ? std::numbers::pi / 4.0 : 1.0);
  const double duration = std::max(0.0, std::min(source.end, scene.end_time) - source.start);
  const double volume = area * std::abs(source.velocity[source.normal()]) * duration;
  return std::min(volume, scene.grid.cell_volume() * scene.grid.cells.cast<double>().prod()) /
         std::pow(source.spacing, 3);
}

/// Meshes too; of a shape that sand can fill, not of planes and what is hollow.
double volume_of(const Shape& shape) {
  return body_fault(shape) ? bounds(shape).sizes().prod() : mass_properties(shape).volume;
}

}  // namespace

SceneCost scene_cost(const Scene& scene) {
  SceneCost cost{};
  const double per_volume = scene.particles_per_cell.cast<double>().prod() / scene.grid.cell_volume();
  for (const Filling& filling : scene.fillings) {
    cost.lattice_points += bounds(filling.shape).sizes().prod() * per_volume;
    cost.particles += volume_of(filling.shape) * per_volume;
  }
  for (const Source& source : scene.sources) cost.particles += sent_by(source, scene);
  cost.render_points = scene.render_points_per_particle * cost.particles;

  const double h = scene.grid.spacing, g = scene.gravity.norm(), speed = fastest(scene);
  const double slow = g > 0.0 ? scene.settings.gravity_courant * std::sqrt(h / g) : scene.frame_interval;
  const double fast = speed > 0.0 ? scene.settings.courant * h / speed : slow;
  const double frames = scene.end_time / scene.frame_interval;
  cost.fewest_steps = std::max(frames, scene.end_time / slow);
  cost.most_steps = std::max(frames, scene.end_time / std::min(slow, fast));

  const bool solids = !scene.walls.empty() || !scene.bodies.empty();
  cost.bytes =
      bytes_of_program +
      scene.grid.cells.cast<double>().prod() * (bytes_per_cell + (solids ? bytes_per_cell_beside : 0.0)) +
      bytes_per_particle * cost.particles + bytes_per_render_point * cost.render_points;
  return cost;
}

}  // namespace talus
