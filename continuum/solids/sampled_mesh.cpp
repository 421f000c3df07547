#include "continuum/solids/sampled_mesh.h"

#include <algorithm>

namespace talus {
namespace {

constexpr double margin = 4.0;  // spacings
constexpr double most_nodes = 4e5;

Eigen::Array3d nodes_of(const Eigen::AlignedBox3d& box, double spacing) {
  return (box.sizes() / spacing).array().ceil() + 2.0 * margin + 1.0;
}

/// Two nodes lie within the thinnest part, as far as that can be paid for.
double spacing_of(const Eigen::AlignedBox3d& box, double thinnest, int intervals) {
  constexpr double coarser = 1.05, finest = 0.02;  // of the usual one
  const double usual = box.sizes().maxCoeff() / intervals;
  double spacing = std::clamp(0.5 * thinnest, finest * usual, usual);
  while (spacing < usual && nodes_of(box, spacing).prod() > most_nodes) spacing *= coarser;
  return std::min(spacing, usual);
}

}  // namespace

SampledMesh sample_distances(const Mesh& mesh, int intervals) {
  const Eigen::AlignedBox3d box = bounds(mesh);
  const double part = thinnest_part(mesh);
  DistanceSamples samples;
  samples.mesh = mesh;
  samples.spacing = spacing_of(box, part, intervals);
  samples.lower = box.min().array() - margin * samples.spacing;
  samples.nodes = nodes_of(box, samples.spacing).cast<int>();
  samples.distances.resize(samples.nodes.cast<Eigen::Index>().prod());
  Eigen::Index n = 0;
  for (int k = 0; k < samples.nodes[2]; ++k) {
    for (int j = 0; j < samples.nodes[1]; ++j) {
      for (int i = 0; i < samples.nodes[0]; ++i, ++n)
        samples.distances[n] =
            signed_distance(mesh, samples.lower + samples.spacing * Eigen::Vector3d(i, j, k));
    }
  }
  const double ball = -2.0 * samples.distances.minCoeff();
  samples.thinnest = ball > 0.0 ? std::min(part, ball) : part;  // a plate may lie between the nodes
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
