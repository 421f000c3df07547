// Random numbers that are the same on every machine: the standard's distributions differ between libraries, its generators do
// not; so the mapping is ours.
#pragma once

#include <cstdint>
#include <random>

namespace talus::dem {

class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : bits_(seed) {}
  /// In [low, high), all 53 bits of a double.
  double operator()(double low, double high) {
    const double unit = static_cast<double>(bits_() >> 11) * 0x1.0p-53;
    return low + (high - low) * unit;
  }

 private:
  std::mt19937_64 bits_;
};

}  // namespace talus::dem
