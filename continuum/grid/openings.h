// What fixed solids leave open of the grid (method.md, section 10): the shares of faces and cells that sand can use.
//
// All arrays are dense over the domain and empty where there are no solids: then everything is open. A share below
// smallest_opening counts as closed.
//
// The wall inside a cell follows from its faces alone: by the divergence theorem the wall's area vector, pointing into
// the sand, is W = sum over axes of (upper share - lower share) e_axis, in units of h^2. It is exact for planes, and a
// uniform slip along such a wall has no divergence.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <span>

#include "continuum/grid/grid.h"

namespace talus {

inline constexpr double smallest_opening = 1e-4;

struct Openings {
  Eigen::ArrayXd distance;  // signed distance at the cells' corners, m; positive where sand may be
  std::array<Eigen::ArrayXd, 3> faces;  // open share of each face
  Eigen::ArrayXd cells;                 // open share of each cell
  Eigen::ArrayXd cell_kernel;           // open share of each cell's deposition kernel
  std::array<Eigen::ArrayXd, 3> face_kernel;
  Eigen::ArrayXd
      friction;  // mu_w of the wall nearest to the cell's centre; negative: as rough as the sand itself
  Eigen::ArrayXi body;  // whose wall that is, by number; -1: a fixed one

  bool any() const { return distance.size() > 0; }
  double face_share(int axis, int dense) const {
    return any() ? faces[static_cast<std::size_t>(axis)][dense] : 1.0;
  }
  double cell_share(int dense) const { return any() ? cells[dense] : 1.0; }
  double cell_kernel_share(int dense) const { return any() ? cell_kernel[dense] : 1.0; }
  double face_kernel_share(int axis, int dense) const {
    return any() ? face_kernel[static_cast<std::size_t>(axis)][dense] : 1.0;
  }
};

/// Distance to the nearest solid, positive outside them, and the friction against it, at a point.
struct WallDistance {
  double distance;  // m
  double friction;  // as Openings::friction
  int body = -1;    // whose it is, by number; -1: fixed
};
using WallDistanceFunction = std::function<WallDistance(const Eigen::Vector3d&)>;

Openings make_openings(const Grid& grid, const WallDistanceFunction& walls);

/// What `solids` that lie in `places` (boxes in space, m) leave open of what fixed walls do: as make_openings of both, at the
/// price of the cells around those places alone. `openings` is overwritten, in its memory.
void add_solids(const Grid& grid, const Openings& fixed, std::span<const Eigen::AlignedBox3d> places,
                const WallDistanceFunction& solids, Openings& openings);

/// Trilinear between the corners; the gradient is that of the interpolant. Positions lie inside the domain.
struct DistanceAndGradient {
  double distance;  // m
  Eigen::Vector3d gradient;
};
DistanceAndGradient distance_at(const Grid& grid, const Openings& openings, const Eigen::Vector3d& position);

/// Share of a unit square where a function that is linear along the edges is positive; values at (0,0), (1,0), (1,1),
/// (0,1). Exact for linear functions.
double positive_share(const std::array<double, 4>& corners);

}  // namespace talus
