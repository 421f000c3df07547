#include "continuum/grid/operators.h"

namespace talus {

StressField make_stress_field(const ActiveRegion& region) {
  return {Eigen::Array3Xd::Zero(3, region.cell_count() + 1), Field::Zero(region.edge_count() + 1),
          Field::Zero(values_per_contact * static_cast<Eigen::Index>(region.contacts.size()))};
}

void add_gradient(const ActiveRegion& region, const Field& cells, double factor, Field& faces) {
  for (int f = 0; f < region.open_faces; ++f) {
    const auto [below, above] = region.face_cells[static_cast<std::size_t>(f)];
    faces[f] += factor * region.face_area[f] * (cells[above] - cells[below]);
  }
}

void gradient_transpose(const ActiveRegion& region, const Field& faces, Field& cells) {
  for (int c = 0; c < region.cell_count(); ++c) {
    const auto& face = region.cell_faces[static_cast<std::size_t>(c)];
    double sum = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int lower = face[2 * axis], upper = face[2 * axis + 1];
      sum += region.face_area[lower] * faces[lower] - region.face_area[upper] * faces[upper];
    }
    cells[c] = sum;
  }
}

void add_stress_divergence(const ActiveRegion& region, const StressField& stress, Field& faces) {
  for (int f = 0; f < region.open_faces; ++f) {
    const auto i = static_cast<std::size_t>(f);
    const auto [below, above] = region.face_strained_cells[i];
    const auto& edge = region.face_edges[i];
    const int axis = region.face_axis[i];
    faces[f] += stress.diagonal(axis, above) - stress.diagonal(axis, below) +  //
                stress.shear[edge[1]] - stress.shear[edge[0]] + stress.shear[edge[3]] - stress.shear[edge[2]];
  }
  for (const Closure& closure : region.closures) {
    const double s = stress.diagonal(closure.axis, closure.cell);
    for (std::size_t k = 0; k < closure.faces.size(); ++k) {
      if (closure.faces[k] != region.null_face()) faces[closure.faces[k]] += closure.weight[k] * s;
    }
  }
  Eigen::Index value = 0;
  for (const Contact& contact : region.contacts) {
    for (const auto& face : contact.faces) {
      const Eigen::Vector3d traction = contact.tangents * stress.contact.segment<2>(value).matrix();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (face[axis] != region.null_face()) faces[face[axis]] += traction[static_cast<int>(axis)];
      }
      value += 2;
    }
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
  for (const Closure& closure : region.closures) {
    double& strained = strain.diagonal(closure.axis, closure.cell);
    strained = 0.0;
    for (std::size_t k = 0; k < closure.faces.size(); ++k)
      strained += closure.weight[k] * faces[closure.faces[k]];
  }
  for (int e = 0; e < region.edge_count(); ++e) {
    const auto& face = region.edge_faces[static_cast<std::size_t>(e)];
    strain.shear[e] = faces[face[0]] - faces[face[1]] + faces[face[2]] - faces[face[3]];
  }
  Eigen::Index value = 0;
  for (const Contact& contact : region.contacts) {
    for (const auto& face : contact.faces) {
      const Eigen::Vector3d slip(faces[face[0]], faces[face[1]], faces[face[2]]);
      strain.contact.segment<2>(value) = (contact.tangents.transpose() * slip).array();
      value += 2;
    }
  }
}

}  // namespace talus
