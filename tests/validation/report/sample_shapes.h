// The made-up column collapses behind the sample results and their pictures.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

namespace talus::testing {

inline constexpr double column_length = 0.048;   // m
inline constexpr double grain_diameter = 0.003;  // m
inline constexpr double run_time = 0.7;          // s

struct Shape {
  const char* code;
  int seed;
  double runout;  // over L0
  double height;  // over L0
};
inline constexpr Shape shapes[] = {
    {"continuum", 1, 1.31, 0.70},
    {"continuum", 2, 1.30, 0.705},
    {"continuum_coarse", 1, 1.36, 0.69},
    {"continuum_short_steps", 1, 1.308, 0.701},
    {"liggghts", 1, 1.22, 0.72},
    {"liggghts", 2, 1.27, 0.71},
    {"liggghts", 3, 1.25, 0.715},
    {"yade", 1, 1.18, 0.73},
    {"yade", 2, 1.25, 0.725},
    {"yade", 3, 1.22, 0.72},
};

inline bool is_continuum(const std::string& code) { return code.rfind("continuum", 0) == 0; }

/// How much of the collapse is over.
inline double done_at(double time) { return 1.0 - std::exp(-std::pow(time / 0.12, 2)); }

/// Depth of the made-up deposit over L0, at x over L0.
inline double depth(const Shape& shape, double x, double done) {
  const double reach = 1.0 + shape.runout * done, height = 1.0 + (shape.height - 1.0) * done;
  return x < reach ? height * (1.0 - done * std::pow(x / reach, 1.3)) : 0.0;
}

}  // namespace talus::testing
