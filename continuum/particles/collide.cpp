#include "continuum/particles/collide.h"

#include <algorithm>
#include <optional>

#include "continuum/parallel.h"
#include "continuum/solids/body_images.h"

namespace talus {
namespace {

/// Where walls meet, coming off one can lead into the other.
constexpr int rounds = 4;
constexpr std::ptrdiff_t particles_per_block = 4096;

/// What the wall takes of a velocity.
Eigen::Vector3d taken_by_wall(const Eigen::Vector3d& velocity, const Eigen::Vector3d& normal,
                              double friction) {
  const double into_wall = -velocity.dot(normal);
  if (into_wall <= 0.0) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d slip = velocity + into_wall * normal;
  const double speed = slip.norm();
  const double stopped = speed > 0.0 ? std::min(1.0, friction * into_wall / speed) : 0.0;
  return -into_wall * normal + stopped * slip;
}

/// As distance_at; outside the domain, by the gradient at the nearest point inside: a wall may stand on its side.
DistanceAndGradient distance_near(const Grid& grid, const Openings& openings,
                                  const Eigen::Vector3d& position) {
  const double inset = 1e-9 * grid.spacing;
  const Eigen::Vector3d inside = position.cwiseMax((grid.origin.array() + inset).matrix())
                                     .cwiseMin((grid.upper().array() - inset).matrix());
  DistanceAndGradient found = distance_at(grid, openings, inside);
  found.distance += found.gradient.dot(position - inside);
  return found;
}

/// Whether no corner of the particle's cell lies in a wall: then the particle does not either. False outside the domain.
bool is_clear(const Grid& grid, const Openings& openings, const Eigen::Vector3d& position) {
  if (!grid.contains(position)) return false;
  const Eigen::Vector3i cell = grid.cell_at(position), corners = grid.cells.array() + 1;
  const Eigen::Index first = cell[0] + corners[0] * (cell[1] + corners[1] * cell[2]);
  double lowest = openings.distance[first];
  for (const Eigen::Index layer : {Eigen::Index{0}, Eigen::Index{corners[0]} * corners[1]}) {
    for (const Eigen::Index row : {0, corners[0]}) {
      const Eigen::Index at = first + layer + row;
      lowest = std::min({lowest, openings.distance[at], openings.distance[at + 1]});
    }
  }
  return lowest >= 0.0;
}

/// A way out of a wall, and how far it is, m.
struct WayOut {
  Eigen::Vector3d normal;
  double length;
};

/// How far it is out of a wall along a direction, m; `longest` where it is no less.
double length_of_way(const Grid& grid, const Openings& openings, const Eigen::Vector3d& position,
                     const Eigen::Vector3d& direction, double longest) {
  constexpr double shortest_stride = 0.02;  // cells
  double length = 0.0;
  while (length < longest) {
    const double here = distance_near(grid, openings, position + length * direction).distance;
    if (here >= 0.0) break;
    length += std::max(-here, shortest_stride * grid.spacing);
  }
  return std::min(length, longest);
}

/// Along the gradient of the interpolated distance, where that is nearly a distance. In the middle of what is thin the gradient vanishes
/// and tells neither where nor how far: there the shortest of 26 ways, to neighbours in a lattice.
std::optional<WayOut> way_out(const Grid& grid, const Openings& openings, const Eigen::Vector3d& position) {
  constexpr double least_gradient = 0.75;  // of 1, where all is well
  constexpr double longest = 3.0;          // cells
  const auto [distance, gradient] = distance_near(grid, openings, position);
  if (distance >= 0.0) return std::nullopt;
  const double slope = gradient.norm();
  if (slope >= least_gradient) return WayOut{gradient.normalized(), -distance / slope};
  WayOut best{Eigen::Vector3d::Zero(), longest * grid.spacing};
  for (int n = 0; n < 27; ++n) {
    const Eigen::Vector3d way = (Eigen::Array3i(n % 3, n / 3 % 3, n / 9) - 1).cast<double>();
    if (way.isZero()) continue;
    const Eigen::Vector3d direction = way.normalized();
    const double length = length_of_way(grid, openings, position, direction, best.length);
    if (length < best.length) best = {direction, length};
  }
  if (best.normal.isZero()) return std::nullopt;
  return best;
}

/// Puts a particle back on the wall it is in, calling touch(normal, cell) at each wall it comes off; returns how far it
/// moved, m.
template <class Touch>
double put_back(const Grid& grid, const Openings& openings, Particles& particles, Eigen::Index p,
                Touch&& touch) {
  double moved = 0.0;
  if (is_clear(grid, openings, particles.positions.col(p))) return moved;
  for (int round = 0; round < rounds; ++round) {
    const Eigen::Vector3d position = particles.positions.col(p);
    const auto way = way_out(grid, openings, position);
    if (!way) break;
    const Eigen::Vector3i cell =
        grid.cell_at(position).cwiseMax(0).cwiseMin(grid.cells - Eigen::Vector3i::Ones());
    touch(way->normal, grid.cell_index(cell));
    // The interpolated distance is not quite a distance; going a little further ends the rounds sooner.
    const double step = way->length + 1e-9 * grid.spacing;
    particles.positions.col(p) += step * way->normal;
    moved += step;
  }
  return moved;
}

}  // namespace

CollisionReport collide_with_walls(const Grid& grid, const Openings& openings, const Eigen::ArrayXd& friction,
                                   Particles& particles, std::span<const Body> bodies) {
  if (!openings.any()) return {};
  const std::vector<Eigen::Vector3d> of_bodies = middles(bodies);
  const auto block = [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    CollisionReport report;
    report.on_bodies.assign(bodies.size(), Eigen::Matrix<double, 6, 1>::Zero());
    for (std::ptrdiff_t p = begin; p < end; ++p) {
      const double moved =
          put_back(grid, openings, particles, p, [&](const Eigen::Vector3d& normal, int cell) {
            const double wall = openings.friction[cell];
            const auto b = static_cast<std::size_t>(openings.body[cell]);
            const bool of_body = openings.body[cell] >= 0 && !bodies.empty();
            Eigen::Vector3d position = particles.positions.col(p);
            if (of_body) position = nearest_image(grid, position, of_bodies[b]);
            Eigen::Vector3d velocity = particles.velocities.col(p);
            if (of_body) velocity -= velocity_at(bodies[b], position);
            const Eigen::Vector3d taken = taken_by_wall(velocity, normal, wall < 0.0 ? friction[p] : wall);
            particles.velocities.col(p) -= taken;
            const Eigen::Vector3d impulse = particles.masses[p] * taken;
            report.impulse -= impulse;
            if (!of_body) return;
            report.on_bodies[b].head<3>() += impulse;
            report.on_bodies[b].tail<3>() += (position - bodies[b].pose.position).cross(impulse);
          });
      report.count += moved > 0.0;
      report.deepest = std::max(report.deepest, moved);
    }
    return report;
  };
  return sum_over_blocks<CollisionReport>(particles.count(), particles_per_block, block);
}

Eigen::Index keep_out_of_walls(const Grid& grid, const Openings& openings, Particles& particles) {
  if (!openings.any()) return 0;
  const auto block = [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    Eigen::Index count = 0;
    for (std::ptrdiff_t p = begin; p < end; ++p)
      count += put_back(grid, openings, particles, p, [](const Eigen::Vector3d&, int) {}) > 0.0;
    return count;
  };
  return sum_over_blocks<Eigen::Index>(particles.count(), particles_per_block, block);
}

}  // namespace talus
