// Bodies within a time step: how far they may move, what pushes them but the sand, and what they leave open of the grid.
#pragma once

#include <span>
#include <vector>

#include "continuum/grid/openings.h"
#include "continuum/solids/body.h"

namespace talus {

/// No body is thinner than this, in cells, where the grid sees it: what goes half a cell into one (largest_allowed_move) is then still nearer to
/// the side it came from, by more than interpolated distances are off.
inline constexpr double least_thickness = 1.3;

/// How much each body is swollen on a grid of this spacing, m (thickening).
std::vector<double> swellings(std::span<const Body> bodies, double spacing);

/// What fixed walls and bodies, with their images over periodic seams, leave open; `openings` is overwritten, in its memory.
void find_openings(const Grid& grid, const Openings& fixed, std::span<const Body> bodies,
                   std::span<const double> swellings, Openings& openings);

/// Whether a position (m) lies in one of the bodies, as wide as the grid sees them.
bool in_a_body(const Grid& grid, std::span<const Body> bodies, std::span<const double> swellings,
               const Eigen::Vector3d& position);

/// The fastest that any part of any body moves, at most, m/s; of those alone that are within the domain or could come near it
/// within dt (s), so that what has left through an open side and falls on and on is not waited for. 0 without such.
double fastest_surface(const Grid& grid, std::span<const Body> bodies, std::span<const Twist> twists,
                       double dt);

/// The bodies' twists after dt of gravity (m/s^2) and of the torques of hinges.
std::vector<Twist> accelerated_twists(std::span<const Body> bodies, const Eigen::Vector3d& gravity,
                                      double dt);

std::vector<Twist> twists_of(std::span<const Body> bodies);
void set_twists(std::span<const Twist> twists, std::span<Body> bodies);
Twist operator+(const Twist& a, const Twist& b);
Twist operator-(const Twist& a, const Twist& b);
Twist operator*(double factor, const Twist& twist);

/// What an impulse and an angular impulse about the centre of mass change the body's twist by.
Twist push(const Body& body, const Eigen::Vector3d& impulse, const Eigen::Vector3d& angular_impulse);

}  // namespace talus
