// How long the longest semi-axis of a particle's ellipsoid is, without its eigenvalues where they are not needed.
#pragma once

#include <Eigen/Core>

namespace talus {

/// Whether the longest semi-axis, the root of the largest eigenvalue of `shape`, exceeds `longest`; false for a shape
/// that is not finite.
bool is_longer(const Eigen::Matrix3d& shape, double longest);

}  // namespace talus
