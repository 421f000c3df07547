#include "continuum/particles/transfer.h"

namespace talus {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

struct Stencil {
  std::array<int, 8> index;
  std::array<double, 8> weight;
};

/// Where a position lies: its cell, and its coordinates within it in [0, 1).
struct Place {
  Vector3i cell;
  Vector3d local;
};

Place place_of(const Grid& grid, const Vector3d& position) {
  const Vector3d scaled = (position - grid.origin) / grid.spacing;
  const Vector3d lower = scaled.array().floor();
  return {lower.cast<int>(), scaled - lower};
}

/// The two cell rows whose centres are around a coordinate: offsets from the own cell, and the upper one's
/// weight.
struct CentredPair {
  int lower;
  double upper_weight;
};

CentredPair centred(double local) {
  return local < 0.5 ? CentredPair{-1, local + 0.5} : CentredPair{0, local - 0.5};
}

/// The index `offset` from `own` along an axis, or `own` where that would leave the domain.
int off_walls(const Grid& grid, int axis, int own, int offset) {
  const int i = grid.wrapped(axis, own + offset);
  return i >= 0 && i < grid.cells[axis] ? i : own;
}

int own_cell(const ActiveRegion& region, const Place& place) {
  return region.cell_of_dense[static_cast<std::size_t>(region.grid.cell_index(place.cell))];
}

/// `surface` takes the weights that fall on empty cells; those that fall into walls go to the own cell.
Stencil cell_stencil(const ActiveRegion& region, const Place& place, int surface) {
  const Grid& grid = region.grid;
  const std::array<CentredPair, 3> pair{centred(place.local[0]), centred(place.local[1]),
                                        centred(place.local[2])};
  Stencil stencil{};
  for (int corner = 0; corner < 8; ++corner) {
    Vector3i i;
    double weight = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto& p = pair[static_cast<std::size_t>(axis)];
      const int up = corner >> axis & 1;
      i[axis] = off_walls(grid, axis, place.cell[axis], p.lower + up);
      weight *= up ? p.upper_weight : 1.0 - p.upper_weight;
    }
    const int cell = region.cell_of_dense[static_cast<std::size_t>(grid.cell_index(i))];
    stencil.index[static_cast<std::size_t>(corner)] = cell < 0 ? surface : cell;
    stencil.weight[static_cast<std::size_t>(corner)] = weight;
  }
  return stencil;
}

Stencil face_stencil(const ActiveRegion& region, const Place& place, int axis) {
  const Grid& grid = region.grid;
  const int b = next_axis(axis), c = last_axis(axis);
  const CentredPair pair_b = centred(place.local[b]), pair_c = centred(place.local[c]);
  const auto& face_of_dense = region.face_of_dense[static_cast<std::size_t>(axis)];
  Stencil stencil{};
  for (int side = 0; side < 2; ++side) {
    const Vector3i own = place.cell + side * Vector3i::Unit(axis);
    const int own_face = face_of_dense[static_cast<std::size_t>(grid.face_index(axis, own))];
    const double along = side ? place.local[axis] : 1.0 - place.local[axis];
    for (int corner = 0; corner < 4; ++corner) {
      const int up_b = corner & 1, up_c = corner >> 1;
      Vector3i i = own;
      i[b] = off_walls(grid, b, own[b], pair_b.lower + up_b);
      i[c] = off_walls(grid, c, own[c], pair_c.lower + up_c);
      const int face = face_of_dense[static_cast<std::size_t>(grid.face_index(axis, i))];
      const auto entry = static_cast<std::size_t>(4 * side + corner);
      stencil.index[entry] = face < 0 ? own_face : face;
      stencil.weight[entry] = along * (up_b ? pair_b.upper_weight : 1.0 - pair_b.upper_weight) *
                              (up_c ? pair_c.upper_weight : 1.0 - pair_c.upper_weight);
    }
  }
  return stencil;
}

double minimum_volume(const Particles& particles, std::span<const Material> materials, Eigen::Index p) {
  const auto material = static_cast<std::size_t>(particles.materials[static_cast<std::size_t>(p)]);
  return particles.masses[p] / materials[material].max_density();
}

}  // namespace

Field deposit_fill(const ActiveRegion& region, const Particles& particles,
                   std::span<const Material> materials) {
  Field fill = Field::Zero(region.cell_count() + 1);
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    const double volume = minimum_volume(particles, materials, p);
    const Stencil stencil =
        cell_stencil(region, place_of(region.grid, particles.positions.col(p)), region.null_cell());
    for (std::size_t k = 0; k < 8; ++k) fill[stencil.index[k]] += stencil.weight[k] * volume;
  }
  fill[region.null_cell()] = 0.0;
  return fill / region.grid.cell_volume();
}

GridState deposit(const ActiveRegion& region, const Particles& particles,
                  std::span<const Material> materials) {
  GridState state;
  state.fill = Field::Zero(region.cell_count() + 1);
  state.friction = Field::Zero(region.cell_count() + 1);
  state.face_mass = state.face_volume = state.velocity = Field::Zero(region.face_count());
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    const double mass = particles.masses[p], volume = minimum_volume(particles, materials, p);
    const double mu =
        materials[static_cast<std::size_t>(particles.materials[static_cast<std::size_t>(p)])].friction;
    const Place place = place_of(region.grid, particles.positions.col(p));
    const Stencil cells = cell_stencil(region, place, own_cell(region, place));
    for (std::size_t k = 0; k < 8; ++k) {
      state.fill[cells.index[k]] += cells.weight[k] * volume;
      state.friction[cells.index[k]] += cells.weight[k] * volume * mu;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const Stencil faces = face_stencil(region, place, axis);
      for (std::size_t k = 0; k < 8; ++k) {
        state.face_mass[faces.index[k]] += faces.weight[k] * mass;
        state.face_volume[faces.index[k]] += faces.weight[k] * volume;
        state.velocity[faces.index[k]] += faces.weight[k] * mass * particles.velocities(axis, p);
      }
    }
  }
  // A face can be in use and yet hold no mass when every particle lies exactly on the opposite face.
  state.velocity = (state.face_mass > 0.0).select(state.velocity / state.face_mass.max(1e-300), 0.0);
  state.friction = (state.fill > 0.0).select(state.friction / state.fill.max(1e-300), 0.0);
  state.fill /= region.grid.cell_volume();
  return state;
}

Eigen::Matrix3Xd interpolate(const ActiveRegion& region, const Field& faces,
                             const Eigen::Matrix3Xd& positions) {
  Eigen::Matrix3Xd values = Eigen::Matrix3Xd::Zero(3, positions.cols());
  for (Eigen::Index p = 0; p < positions.cols(); ++p) {
    const Place place = place_of(region.grid, positions.col(p));
    for (int axis = 0; axis < 3; ++axis) {
      const Stencil stencil = face_stencil(region, place, axis);
      for (std::size_t k = 0; k < 8; ++k) values(axis, p) += stencil.weight[k] * faces[stencil.index[k]];
    }
  }
  return values;
}

}  // namespace talus
