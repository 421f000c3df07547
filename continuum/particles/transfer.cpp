#include "continuum/particles/transfer.h"

#include "continuum/grid/stencil.h"

namespace talus {
namespace {

int own_cell(const ActiveRegion& region, const Place& place) {
  return region.cell_of_dense[static_cast<std::size_t>(region.grid.cell_index(place.cell))];
}

/// `surface` takes the weights that fall on empty cells; those that fall into walls go to the own cell.
Stencil cells_around(const ActiveRegion& region, const Place& place, int surface) {
  const auto lookup = [&](int dense) { return region.cell_of_dense[static_cast<std::size_t>(dense)]; };
  return cell_stencil(region.grid, place, lookup, surface);
}

Stencil faces_around(const ActiveRegion& region, const Place& place, int axis) {
  const auto& face_of_dense = region.face_of_dense[static_cast<std::size_t>(axis)];
  const auto lookup = [&](int dense) { return face_of_dense[static_cast<std::size_t>(dense)]; };
  Stencil stencil = face_stencil(region.grid, place, axis, lookup);
  // What a cell closed along this axis on both sides would share goes to the wall: to the null face.
  for (int& face : stencil.index) face = face < 0 ? region.null_face() : face;
  return stencil;
}

}  // namespace

Eigen::ArrayXd minimum_volumes(const Particles& particles, std::span<const Material> materials) {
  Eigen::ArrayXd volumes = particles.masses;
  for (Eigen::Index p = 0; p < volumes.size(); ++p)
    volumes[p] /=
        materials[static_cast<std::size_t>(particles.materials[static_cast<std::size_t>(p)])].max_density();
  return volumes;
}

Field deposit_fill(const ActiveRegion& region, const Particles& particles,
                   std::span<const Material> materials) {
  Field fill = Field::Zero(region.cell_count() + 1);
  const Eigen::ArrayXd volumes = minimum_volumes(particles, materials);
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    const Stencil stencil =
        cells_around(region, place_of(region.grid, particles.positions.col(p)), region.null_cell());
    for (std::size_t k = 0; k < 8; ++k) fill[stencil.index[k]] += stencil.weight[k] * volumes[p];
  }
  fill[region.null_cell()] = 0.0;
  return fill / (region.grid.cell_volume() * region.cell_kernel);
}

GridState deposit(const ActiveRegion& region, const Particles& particles, std::span<const Material> materials,
                  const Eigen::ArrayXd& friction) {
  GridState state;
  state.fill = Field::Zero(region.cell_count() + 1);
  state.friction = Field::Zero(region.cell_count() + 1);
  state.face_mass = state.face_volume = state.velocity = Field::Zero(region.face_count());
  const Eigen::ArrayXd volumes = minimum_volumes(particles, materials);
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    const double mass = particles.masses[p], volume = volumes[p];
    const Place place = place_of(region.grid, particles.positions.col(p));
    const Stencil cells = cells_around(region, place, own_cell(region, place));
    for (std::size_t k = 0; k < 8; ++k) {
      state.fill[cells.index[k]] += cells.weight[k] * volume;
      state.friction[cells.index[k]] += cells.weight[k] * volume * friction[p];
    }
    const auto gradient = Eigen::Map<const Eigen::Matrix3d>(particles.gradients.col(p).data());
    for (int axis = 0; axis < 3; ++axis) {
      const Stencil faces = faces_around(region, place, axis);
      const auto affine = (gradient.row(axis) * faces.offset).eval();
      for (int k = 0; k < 8; ++k) {
        const auto entry = static_cast<std::size_t>(k);
        const double weight = faces.weight[entry];
        state.face_mass[faces.index[entry]] += weight * mass;
        state.face_volume[faces.index[entry]] += weight * volume;
        state.velocity[faces.index[entry]] += weight * mass * (particles.velocities(axis, p) + affine[k]);
      }
    }
  }
  for (Field* field : {&state.face_mass, &state.face_volume, &state.velocity})
    (*field)[region.null_face()] = 0.0;
  // A face can be in use and yet hold no mass when every particle lies exactly on the opposite face.
  state.velocity = (state.face_mass > 0.0).select(state.velocity / state.face_mass.max(1e-300), 0.0);
  state.friction = (state.fill > 0.0).select(state.friction / state.fill.max(1e-300), 0.0);
  state.fill /= region.grid.cell_volume() * region.cell_kernel;
  return state;
}

Eigen::Matrix3Xd interpolate(const ActiveRegion& region, const Field& faces,
                             const Eigen::Matrix3Xd& positions) {
  Eigen::Matrix3Xd values = Eigen::Matrix3Xd::Zero(3, positions.cols());
  for (Eigen::Index p = 0; p < positions.cols(); ++p) {
    const Place place = place_of(region.grid, positions.col(p));
    for (int axis = 0; axis < 3; ++axis) {
      const Stencil stencil = faces_around(region, place, axis);
      for (std::size_t k = 0; k < 8; ++k) values(axis, p) += stencil.weight[k] * faces[stencil.index[k]];
    }
  }
  return values;
}

Eigen::Matrix<double, 9, Eigen::Dynamic> interpolate_gradient(const ActiveRegion& region, const Field& faces,
                                                              const Eigen::Matrix3Xd& positions) {
  Eigen::Matrix<double, 9, Eigen::Dynamic> values(9, positions.cols());
  for (Eigen::Index p = 0; p < positions.cols(); ++p) {
    const Place place = place_of(region.grid, positions.col(p));
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const Stencil stencil = faces_around(region, place, axis);
      for (int k = 0; k < 8; ++k)
        gradient.row(axis) +=
            faces[stencil.index[static_cast<std::size_t>(k)]] * stencil.gradient.col(k).transpose();
    }
    values.col(p) = gradient.reshaped();
  }
  return values;
}

}  // namespace talus
