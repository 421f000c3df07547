#include "continuum/grid/operators.h"

namespace talus {

StressField make_stress_field(const ActiveRegion& region) {
  return {Eigen::Array3Xd::Zero(3, region.cell_count() + 1), Field::Zero(region.edge_count() + 1)};
}

void add_gradient(const ActiveRegion& region, const Field& cells, double factor, Field& faces) {
  for (int f = 0; f < region.open_faces; ++f) {
    const auto [below, above] = region.face_cells[static_cast<std::size_t>(f)];
    faces[f] += factor * (cells[above] - cells[below]);
  }
}

void gradient_transpose(const ActiveRegion& region, const Field& faces, Field& cells) {
  for (int c = 0; c < region.cell_count(); ++c) {
    const auto& face = region.cell_faces[static_cast<std::size_t>(c)];
    cells[c] =
        faces[face[0]] - faces[face[1]] + faces[face[2]] - faces[face[3]] + faces[face[4]] - faces[face[5]];
  }
}

void add_stress_divergence(const ActiveRegion& region, const StressField& stress, Field& faces) {
  for (int f = 0; f < region.open_faces; ++f) {
    const auto i = static_cast<std::size_t>(f);
    const auto [below, above] = region.face_cells[i];
    const auto& edge = region.face_edges[i];
    const int axis = region.face_axis[i];
    faces[f] += stress.diagonal(axis, above) - stress.diagonal(axis, below) +  //
                stress.shear[edge[1]] - stress.shear[edge[0]] + stress.shear[edge[3]] - stress.shear[edge[2]];
  }
}

void stress_divergence_transpose(const ActiveRegion& region, const Field& faces, StressField& strain) {
  for (int c = 0; c < region.cell_count(); ++c) {
    const auto& face = region.cell_faces[static_cast<std::size_t>(c)];
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(2 * axis);
      strain.diagonal(axis, c) = faces[face[a]] - faces[face[a + 1]];
    }
  }
  for (int e = 0; e < region.edge_count(); ++e) {
    const auto& face = region.edge_faces[static_cast<std::size_t>(e)];
    strain.shear[e] = faces[face[0]] - faces[face[1]] + faces[face[2]] - faces[face[3]];
  }
}

}  // namespace talus
