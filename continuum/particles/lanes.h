// Four particles at a time.
#pragma once

#include <Eigen/Core>
#include <array>

namespace talus {

inline constexpr int lane_count = 4;
using Lanes = Eigen::Array<double, lane_count, 1>;  // a value of each of four particles

/// Up to four particles; lanes beyond `count` repeat the last one.
struct LaneParticles {
  std::array<int, lane_count> index;
  int count;
};

}  // namespace talus
