// Which cells and faces a point shares its mass among: the trilinear kernel on the staggered grid.
//
// Weights beyond the domain go to the row beside it; those that fall on a cell or face which cannot be used (inside a
// solid, or beyond the free surface) go to the one of the point's own cell, and where that is closed too, to the own
// cell's opposite face. So weights always sum to one, except where the own cell is closed on both sides.
#pragma once

#include <Eigen/Core>
#include <array>

#include "continuum/grid/grid.h"

namespace talus {

/// Eight entries; an index is what the lookup gave for it, -1 where the weight is lost.
struct Stencil {
  std::array<int, 8> index;
  std::array<double, 8> weight;
  Eigen::Matrix<double, 3, 8> gradient;  // of the weights, 1/m
  Eigen::Matrix<double, 3, 8> offset;  // from the point to where each weight fell before it was redirected, m
};

/// Where a position lies: its cell, and its coordinates within it in [0, 1).
struct Place {
  Eigen::Vector3i cell;
  Eigen::Vector3d local;
};

inline Place place_of(const Grid& grid, const Eigen::Vector3d& position) {
  const Eigen::Vector3d scaled = (position - grid.origin) / grid.spacing;
  const Eigen::Vector3d lower = scaled.array().floor();
  return {lower.cast<int>(), scaled - lower};
}

/// One axis of a kernel that is centred in cells: the two rows around the point, as offsets from its own cell, their
/// weights, and how far each lies from the point, in cells.
struct CentredPair {
  std::array<int, 2> offset;
  std::array<double, 2> weight;
  std::array<double, 2> away;
};

inline CentredPair centred_pair(double local) {
  const int lower = local < 0.5 ? -1 : 0;
  const double upper_weight = local - 0.5 - lower;
  return {{lower, lower + 1}, {1.0 - upper_weight, upper_weight}, {lower + 0.5 - local, lower + 1.5 - local}};
}

/// The index `offset` from `own` along an axis, or `own` where that would leave the domain.
inline int kept_inside(const Grid& grid, int axis, int own, int offset) {
  const int i = grid.wrapped(axis, own + offset);
  return i >= 0 && i < grid.cells[axis] ? i : own;
}

/// What a lookup answers, beside an index >= 0, for a cell that is empty, and for one that solids fill.
inline constexpr int is_empty = -1;
inline constexpr int is_closed = -2;

/// `lookup(dense)`: the index to store for the cell of that dense index, is_empty or is_closed. The weights of empty
/// cells go to `surface`. Gradients and offsets are not filled in.
template <class Lookup>
Stencil cell_stencil(const Grid& grid, const Place& place, const Lookup& lookup, int surface) {
  const std::array<CentredPair, 3> pair{centred_pair(place.local[0]), centred_pair(place.local[1]),
                                        centred_pair(place.local[2])};
  Stencil stencil{};
  for (int corner = 0; corner < 8; ++corner) {
    Eigen::Vector3i i;
    double weight = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto& p = pair[static_cast<std::size_t>(axis)];
      const auto up = static_cast<std::size_t>(corner >> axis & 1);
      i[axis] = kept_inside(grid, axis, place.cell[axis], p.offset[up]);
      weight *= p.weight[up];
    }
    const auto entry = static_cast<std::size_t>(corner);
    const int found = lookup(grid.cell_index(i));
    stencil.index[entry] = found >= 0          ? found
                           : found == is_empty ? surface
                                               : lookup(grid.cell_index(place.cell));
    stencil.weight[entry] = weight;
  }
  return stencil;
}

/// `lookup(dense)`: the index to store for the face of that dense index, or negative where it cannot be used.
template <class Lookup>
Stencil face_stencil(const Grid& grid, const Place& place, int axis, const Lookup& lookup) {
  const int b = next_axis(axis), c = last_axis(axis);
  const CentredPair pair_b = centred_pair(place.local[b]), pair_c = centred_pair(place.local[c]);
  std::array<int, 2> own;
  for (int side = 0; side < 2; ++side)
    own[static_cast<std::size_t>(side)] =
        lookup(grid.face_index(axis, place.cell + side * Eigen::Vector3i::Unit(axis)));
  Stencil stencil{};
  const double per_metre = 1.0 / grid.spacing;
  for (int side = 0; side < 2; ++side) {
    const double along = side ? place.local[axis] : 1.0 - place.local[axis];
    const int fallback = own[static_cast<std::size_t>(side)] >= 0 ? own[static_cast<std::size_t>(side)]
                                                                  : own[static_cast<std::size_t>(1 - side)];
    for (int corner = 0; corner < 4; ++corner) {
      const auto up_b = static_cast<std::size_t>(corner & 1), up_c = static_cast<std::size_t>(corner >> 1);
      Eigen::Vector3i i = place.cell + side * Eigen::Vector3i::Unit(axis);
      i[b] = kept_inside(grid, b, i[b], pair_b.offset[up_b]);
      i[c] = kept_inside(grid, c, i[c], pair_c.offset[up_c]);
      const int found = lookup(grid.face_index(axis, i));
      const int entry = 4 * side + corner;
      const double w_b = pair_b.weight[up_b], w_c = pair_c.weight[up_c];
      stencil.index[static_cast<std::size_t>(entry)] = found >= 0 ? found : fallback;
      stencil.weight[static_cast<std::size_t>(entry)] = along * w_b * w_c;
      stencil.gradient(axis, entry) = (side ? per_metre : -per_metre) * w_b * w_c;
      stencil.gradient(b, entry) = along * (up_b ? per_metre : -per_metre) * w_c;
      stencil.gradient(c, entry) = along * w_b * (up_c ? per_metre : -per_metre);
      stencil.offset(axis, entry) = grid.spacing * (side - place.local[axis]);
      stencil.offset(b, entry) = grid.spacing * pair_b.away[up_b];
      stencil.offset(c, entry) = grid.spacing * pair_c.away[up_c];
    }
  }
  return stencil;
}

}  // namespace talus
