// The continuum's material points, as a structure of arrays.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace talus {

struct Particles {
  Eigen::Matrix3Xd positions;   // m, 3 x n
  Eigen::Matrix3Xd velocities;  // m/s, 3 x n
  Eigen::ArrayXd masses;        // kg
  std::vector<int> materials;   // index into the scene's materials

  Eigen::Index count() const { return masses.size(); }
};

}  // namespace talus
