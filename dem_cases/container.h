// What holds the grains of a case, besides fixed grains: planes and shells that a discrete code builds in its own way.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "dem_cases/case.h"

namespace talus::dem {

/// How far the centres of a rough floor's fixed grains lie below z = 0, in mean diameters. Grains of the
/// column sink into the hollows between them; at this depth z = 0 is where a flat floor would carry the same
/// column (README of column_collapse: how it was measured).
inline constexpr double floor_centre_depth = 0.5;

enum class Surface {
  wall,   // has the case's wall friction
  floor,  // as rough as a grain
};

/// An infinite plane across one axis.
struct Plane {
  std::string name;  // in decks and messages; letters and '_'
  int axis;          // 0, 1, 2
  double at;         // m
  int inward;        // +1 where the grains are at greater coordinates, -1 at smaller ones
  Surface surface = Surface::wall;
  bool until_release = false;    // a gate
  bool must_stay_clear = false;  // a grain that touches it voids the run
};

/// A profile turned about the z axis, of flat triangles whose corners lie on the surface of revolution.
struct Shell {
  std::string name;
  std::vector<Eigen::Vector2d> profile;  // (r, z), m, z increasing
  bool until_release = false;
  double rise_speed = 0.0;  // m/s, from the release on
};

struct Container {
  bool periodic = false;         // across y, with period upper.y - lower.y
  Eigen::Vector3d lower, upper;  // m, what the codes' boxes must hold, beside the packing
  double lowest;                 // m, no centre of a grain may be below
  std::vector<Plane> planes;
  std::vector<Shell> shells;
};

Container container_of(const Case& a_case);

using Triangle = std::array<Eigen::Vector3d, 3>;

/// The shell's triangles, at least `shell_segments` around; none is degenerate.
inline constexpr int shell_segments = 48;
std::vector<Triangle> triangles_of(const Shell& shell);

/// The name of the plane or shell that a grain with its centre there has leaked through; empty for none.
std::string leak(const Container& container, const Eigen::Vector3d& centre, bool released);

}  // namespace talus::dem
