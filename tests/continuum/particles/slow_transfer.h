// The transfer as grid/stencil.h defines it, a particle and a corner at a time: what the fast one is compared with.
#pragma once

#include "continuum/grid/stencil.h"
#include "continuum/particles/transfer.h"

namespace talus::testing {

struct SlowTransfer {
  const ActiveRegion& region;
  const Openings& openings;

  /// `surface` takes the weights that fall on empty cells.
  Stencil cells_around(const Place& place, int surface) const {
    const auto lookup = [&](int dense) {
      const int cell = region.cell_of_dense[static_cast<std::size_t>(dense)];
      if (cell >= 0) return cell;
      return openings.cell_share(dense) == 0.0 ? is_closed : is_empty;
    };
    return cell_stencil(region.grid, place, lookup, surface);
  }
  Stencil faces_around(const Place& place, int axis) const {
    const auto& face_of_dense = region.face_of_dense[static_cast<std::size_t>(axis)];
    const auto lookup = [&](int dense) { return face_of_dense[static_cast<std::size_t>(dense)]; };
    Stencil stencil = face_stencil(region.grid, place, axis, lookup);
    for (int& face : stencil.index) face = face < 0 ? region.null_face() : face;
    return stencil;
  }

  Field fill(const Particles& particles, const Eigen::ArrayXd& volumes, bool surface_is_own) const {
    Field sum = Field::Zero(region.cell_count() + 1);
    for (Eigen::Index p = 0; p < particles.count(); ++p) {
      const Place place = place_of(region.grid, particles.positions.col(p));
      const int own = region.cell_of_dense[static_cast<std::size_t>(region.grid.cell_index(place.cell))];
      const Stencil stencil = cells_around(place, surface_is_own ? own : region.null_cell());
      for (std::size_t k = 0; k < 8; ++k) sum[stencil.index[k]] += stencil.weight[k] * volumes[p];
    }
    sum[region.null_cell()] = 0.0;
    return sum / (region.grid.cell_volume() * region.cell_kernel);
  }

  GridState deposit(const Particles& particles, const Eigen::ArrayXd& volumes,
                    const Eigen::ArrayXd& friction) const {
    GridState state;
    state.fill = fill(particles, volumes, true);
    state.friction = fill(particles, volumes * friction, true);
    state.friction = (state.fill > 0.0).select(state.friction / state.fill.max(1e-300), 0.0);
    state.face_mass = state.face_volume = state.velocity = Field::Zero(region.face_count());
    for (Eigen::Index p = 0; p < particles.count(); ++p) {
      const Place place = place_of(region.grid, particles.positions.col(p));
      for (int axis = 0; axis < 3; ++axis) {
        const Stencil faces = faces_around(place, axis);
        const auto affine = (gradient_matrix(particles, p).row(axis) * faces.offset).eval();
        for (int k = 0; k < 8; ++k) {
          const auto entry = static_cast<std::size_t>(k);
          const double mass = faces.weight[entry] * particles.masses[p];
          state.face_mass[faces.index[entry]] += mass;
          state.face_volume[faces.index[entry]] += faces.weight[entry] * volumes[p];
          state.velocity[faces.index[entry]] += mass * (particles.velocities(axis, p) + affine[k]);
        }
      }
    }
    for (Field* field : {&state.face_mass, &state.face_volume, &state.velocity})
      (*field)[region.null_face()] = 0.0;
    state.velocity = (state.face_mass > 0.0).select(state.velocity / state.face_mass.max(1e-300), 0.0);
    return state;
  }

  Eigen::Matrix3Xd interpolate(const Field& faces, const Eigen::Matrix3Xd& positions) const {
    Eigen::Matrix3Xd values = Eigen::Matrix3Xd::Zero(3, positions.cols());
    for (Eigen::Index p = 0; p < positions.cols(); ++p) {
      const Place place = place_of(region.grid, positions.col(p));
      for (int axis = 0; axis < 3; ++axis) {
        const Stencil stencil = faces_around(place, axis);
        for (std::size_t k = 0; k < 8; ++k) values(axis, p) += stencil.weight[k] * faces[stencil.index[k]];
      }
    }
    return values;
  }

  Eigen::Matrix<double, 9, Eigen::Dynamic> gradient(const Field& faces,
                                                    const Eigen::Matrix3Xd& positions) const {
    Eigen::Matrix<double, 9, Eigen::Dynamic> values(9, positions.cols());
    for (Eigen::Index p = 0; p < positions.cols(); ++p) {
      const Place place = place_of(region.grid, positions.col(p));
      Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
      for (int axis = 0; axis < 3; ++axis) {
        const Stencil stencil = faces_around(place, axis);
        for (int k = 0; k < 8; ++k)
          sum.row(axis) +=
              faces[stencil.index[static_cast<std::size_t>(k)]] * stencil.gradient.col(k).transpose();
      }
      values.col(p) = sum.reshaped();
    }
    return values;
  }
};

}  // namespace talus::testing
