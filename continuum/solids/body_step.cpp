#include "continuum/solids/body_step.h"

#include <algorithm>
#include <limits>

#include "continuum/solids/body_images.h"

namespace talus {
namespace {

/// A body as the grid sees it, whole periods away from where its pose says.
struct Image {
  std::size_t body;
  Eigen::Vector3d shift;
  Eigen::AlignedBox3d place;  // where it closes anything
};

std::vector<Image> images_in_domain(const Grid& grid, std::span<const Body> bodies,
                                    std::span<const double> swellings) {
  const Eigen::Vector3d layer = Eigen::Vector3d::Constant(grid.spacing);  // add_solids looks so far around
  std::vector<Image> images;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Eigen::AlignedBox3d box = bounds(bodies[b]);
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(swellings[b] + 0.5 * grid.spacing);
    const Eigen::AlignedBox3d place(box.min() - margin, box.max() + margin);
    for (const Eigen::Vector3d& shift : shifts_into_domain(grid, {place.min() - layer, place.max() + layer}))
      images.push_back({b, shift, {place.min() + shift, place.max() + shift}});
  }
  return images;
}

/// Along periodic axes one is always near.
bool may_be_near_domain(const Grid& grid, const Eigen::AlignedBox3d& box, double margin) {
  for (int axis = 0; axis < 3; ++axis) {
    if (grid.periodic[static_cast<std::size_t>(axis)]) continue;
    if (box.min()[axis] - margin > grid.upper()[axis] || box.max()[axis] + margin < grid.origin[axis])
      return false;
  }
  return true;
}

}  // namespace

std::vector<double> swellings(std::span<const Body> bodies, double spacing) {
  std::vector<double> swollen;
  for (const Body& body : bodies) swollen.push_back(thickening(body, least_thickness * spacing));
  return swollen;
}

void find_openings(const Grid& grid, const Openings& fixed, std::span<const Body> bodies,
                   std::span<const double> swellings, Openings& openings) {
  const std::vector<Image> images = images_in_domain(grid, bodies, swellings);
  std::vector<Eigen::AlignedBox3d> places;
  for (const Image& image : images) places.push_back(image.place);
  add_solids(
      grid, fixed, places,
      [&](const Eigen::Vector3d& point) {
        WallDistance nearest{std::numeric_limits<double>::max(), 0.0};
        for (const auto& [b, shift, place] : images) {
          if (!place.contains(point) && place.exteriorDistance(point) > 2.0 * grid.spacing) continue;
          const double distance = signed_distance(bodies[b], point - shift) - swellings[b];
          if (distance < nearest.distance) nearest = {distance, bodies[b].friction, static_cast<int>(b)};
        }
        return nearest;
      },
      openings);
}

bool in_a_body(const Grid& grid, std::span<const Body> bodies, std::span<const double> swellings,
               const Eigen::Vector3d& position) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Eigen::Vector3d image = nearest_image(grid, position, bounds(bodies[b]).center());
    if (signed_distance(bodies[b], image) < swellings[b]) return true;
  }
  return false;
}

double fastest_surface(const Grid& grid, std::span<const Body> bodies, std::span<const Twist> twists,
                       double dt) {
  double fastest = 0.0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Eigen::AlignedBox3d box = bounds(bodies[b]);
    const Eigen::Vector3d& centre = bodies[b].pose.position;
    const double reach = (box.max() - centre).cwiseAbs().cwiseMax((box.min() - centre).cwiseAbs()).norm();
    const double speed = twists[b].velocity.norm() + reach * twists[b].angular_velocity.norm();
    if (may_be_near_domain(grid, box, 2.0 * grid.spacing + speed * dt)) fastest = std::max(fastest, speed);
  }
  return fastest;
}

std::vector<Twist> accelerated_twists(std::span<const Body> bodies, const Eigen::Vector3d& gravity,
                                      double dt) {
  std::vector<Twist> twists;
  for (const Body& body : bodies) {
    const auto* hinge = std::get_if<Hinge>(&body.motion);
    const Eigen::Vector3d torque =
        hinge ? Eigen::Vector3d(hinge->torque * hinge->axis) : Eigen::Vector3d::Zero();
    twists.push_back(body.twist + push(body, dt * body.mass * gravity, dt * torque));
  }
  return twists;
}

std::vector<Twist> twists_of(std::span<const Body> bodies) {
  std::vector<Twist> twists;
  for (const Body& body : bodies) twists.push_back(body.twist);
  return twists;
}

void set_twists(std::span<const Twist> twists, std::span<Body> bodies) {
  for (std::size_t b = 0; b < bodies.size(); ++b) bodies[b].twist = twists[b];
}

Twist operator+(const Twist& a, const Twist& b) {
  return {a.velocity + b.velocity, a.angular_velocity + b.angular_velocity};
}
Twist operator-(const Twist& a, const Twist& b) {
  return {a.velocity - b.velocity, a.angular_velocity - b.angular_velocity};
}
Twist operator*(double factor, const Twist& twist) {
  return {factor * twist.velocity, factor * twist.angular_velocity};
}

Twist push(const Body& body, const Eigen::Vector3d& impulse, const Eigen::Vector3d& angular_impulse) {
  Eigen::Matrix<double, 6, 1> wrench;
  wrench << impulse, angular_impulse;
  const Eigen::Matrix<double, 6, 1> change = inverse_mass(body) * wrench;
  return {change.head<3>(), change.tail<3>()};
}

}  // namespace talus
