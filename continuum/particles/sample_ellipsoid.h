// Random numbers that hang on what they are for, not on who asked first; and places in an ellipsoid by them.
#pragma once

#include <Eigen/Cholesky>
#include <cstdint>

namespace talus {

/// SplitMix64 (Steele, Lea and Flood 2014): a sequence that its keys fix.
class Draws {
 public:
  explicit Draws(std::uint64_t seed, std::uint64_t first_key, std::uint64_t second_key)
      : state_(mixed(mixed(mixed(seed) + first_key) + second_key)) {}

  std::uint64_t bits() { return mixed(state_ += golden); }
  /// In [0, 1).
  double unit() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  /// Uniform in the unit ball.
  Eigen::Vector3d in_ball() {
    for (;;) {
      const std::uint64_t drawn = bits();
      const auto symmetric = [&](int shift) {  // one of 2^21 numbers in (-1, 1)
        return (static_cast<double>(drawn >> shift & 0x1fffff) + 0.5) * 0x1.0p-20 - 1.0;
      };
      Eigen::Vector3d place(symmetric(0), symmetric(21), symmetric(42));
      if (place.squaredNorm() <= 1.0) return place;
    }
  }

 private:
  static constexpr std::uint64_t golden = 0x9e3779b97f4a7c15;
  static std::uint64_t mixed(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

/// L of S = L L', lower triangular: it maps the unit ball onto the ellipsoid of S, uniformly.
inline Eigen::Matrix3d map_of_ball(const Eigen::Matrix3d& shape) {
  return Eigen::LLT<Eigen::Matrix3d>(shape).matrixL();
}

}  // namespace talus
