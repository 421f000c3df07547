// Meshes whose signed distance is looked up instead of searched for: what moves is asked for it in every step.
//
// d is computed once at the nodes of a lattice of spacing s about the mesh and is trilinear between them. The distance changes
// no faster than one moves, so the error is below sqrt(3)/2 s everywhere; off the medial axis of a surface of curvature radius
// R it is of order s^2 / R, and beside edges up to some 0.4 s: sharp ones come out rounded. Beyond the lattice it is
// the way to the lattice and the distance from there: no less than the mesh's own, and positive.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>

#include "continuum/solids/mesh.h"

namespace talus {

struct DistanceSamples {
  Mesh mesh;
  Eigen::Vector3d lower;     // m, the first node
  double spacing;            // s, m
  Eigen::Vector3i nodes;     // along each axis
  Eigen::ArrayXd distances;  // m, x fastest
  double thinnest;           // m, of thinnest_part and the largest ball inside

  double at(const Eigen::Vector3i& node) const {
    return distances[node[0] + nodes[0] * (node[1] + static_cast<Eigen::Index>(nodes[1]) * node[2])];
  }
};

/// Copies share the samples, which never change.
struct SampledMesh {
  std::shared_ptr<const DistanceSamples> samples;
};

/// The lattice reaches 4 s beyond the mesh, and s is 1/`intervals` of its longest side, or half of its thinnest_part where that is
/// less, as far as 400 000 nodes go. It costs some 20 us a node (mesh.h): 2 s
/// for a mesh of 20 000 triangles that is as long as wide and high.
inline constexpr int default_sampling_intervals = 40;
SampledMesh sample_distances(const Mesh& mesh, int intervals = default_sampling_intervals);

/// m, negative inside; see above for its error.
double signed_distance(const SampledMesh& mesh, const Eigen::Vector3d& point);
/// The smallest axis-aligned box that holds the solid, m.
Eigen::AlignedBox3d bounds(const SampledMesh& mesh);

}  // namespace talus
