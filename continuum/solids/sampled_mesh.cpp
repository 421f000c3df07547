#include "continuum/solids/sampled_mesh.h"

#include <algorithm>

namespace talus {

SampledMesh sample_distances(const Mesh& mesh, int intervals) {
  constexpr double margin = 4.0;  // spacings
  const Eigen::AlignedBox3d box = bounds(mesh);
  DistanceSamples samples;
  samples.mesh = mesh;
  samples.spacing = box.sizes().maxCoeff() / intervals;
  samples.lower = box.min().array() - margin * samples.spacing;
  samples.nodes =
      (box.sizes() / samples.spacing).array().ceil().cast<int>() + static_cast<int>(2.0 * margin) + 1;
  samples.distances.resize(samples.nodes.cast<Eigen::Index>().prod());
  Eigen::Index n = 0;
  for (int k = 0; k < samples.nodes[2]; ++k) {
    for (int j = 0; j < samples.nodes[1]; ++j) {
      for (int i = 0; i < samples.nodes[0]; ++i, ++n)
        samples.distances[n] =
            signed_distance(mesh, samples.lower + samples.spacing * Eigen::Vector3d(i, j, k));
    }
  }
  return {std::make_shared<const DistanceSamples>(std::move(samples))};
}

double signed_distance(const SampledMesh& mesh, const Eigen::Vector3d& point) {
  const DistanceSamples& samples = *mesh.samples;
  const Eigen::Vector3d asked = (point - samples.lower) / samples.spacing;
  const Eigen::Vector3d last = (samples.nodes.array() - 1).cast<double>();
  const Eigen::Vector3d place = asked.cwiseMax(0.0).cwiseMin(last);
  const Eigen::Vector3i node = place.cast<int>().cwiseMin((samples.nodes.array() - 2).matrix());
  const Eigen::Vector3d share = place - node.cast<double>();
  // The mesh itself would cost hundreds of times as much, where nobody needs to know exactly.
  double distance = samples.spacing * (asked - place).norm();
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3i step(corner & 1, corner >> 1 & 1, corner >> 2);
    double weight = 1.0;
    for (int axis = 0; axis < 3; ++axis) weight *= step[axis] == 1 ? share[axis] : 1.0 - share[axis];
    distance += weight * samples.at(node + step);
  }
  return distance;
}

Eigen::AlignedBox3d bounds(const SampledMesh& mesh) { return bounds(mesh.samples->mesh); }

}  // namespace talus
