// Active regions with everything an operator can meet: holes, walls with and without friction, periodic axes.
#pragma once

#include <gtest/gtest.h>

#include <ostream>
#include <random>

#include "continuum/grid/operators.h"

namespace talus::testing {

struct Setting {
  const char* name;
  std::array<bool, 3> periodic;
  Eigen::Vector3i cells;
  bool solids = false;  // a slope and a ball, with friction
};

inline void PrintTo(const Setting& setting, std::ostream* out) { *out << setting.name; }

inline Field random_field(Eigen::Index n, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Field::NullaryExpr(n, [&] { return normal(random); });
}

/// A ragged cloud of particles: active cells with holes, against the walls here and there.
struct RaggedSand {
  Grid grid;
  DomainSides sides;
  Openings openings;
  Eigen::Matrix3Xd positions;

  ActiveRegion region() const { return make_active_region(grid, sides, positions, openings); }
};

inline RaggedSand ragged_sand(const Setting& setting, std::mt19937_64& random) {
  RaggedSand sand;
  sand.grid = {Eigen::Vector3d::Zero(), 0.5, setting.cells, setting.periodic};
  for (auto& axis : sand.sides) axis = {Side{true, 0.4}, Side{true, 0.0}};
  const int n = setting.cells.prod();
  sand.positions.resize(3, n);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int p = 0; p < n; ++p) {
    for (int axis = 0; axis < 3; ++axis) sand.positions(axis, p) = 0.5 * setting.cells[axis] * unit(random);
  }
  if (!setting.solids) return sand;
  const Eigen::Vector3d middle = 0.25 * setting.cells.cast<double>(),
                        uphill = Eigen::Vector3d(1.0, 0.7, 2.0).normalized();
  sand.openings = make_openings(sand.grid, [&](const Eigen::Vector3d& x) {
    const double slope = (x - 0.6 * middle).dot(uphill), ball = (x - 1.4 * middle).norm() - 0.6;
    return WallDistance{std::min(slope, ball), 0.3};
  });
  return sand;
}

inline ActiveRegion ragged_region(const Setting& setting, std::mt19937_64& random) {
  return ragged_sand(setting, random).region();
}

inline const auto ragged_settings = ::testing::Values(
    Setting{"box", {false, false, false}, {5, 6, 4}}, Setting{"periodic", {true, true, true}, {4, 6, 4}},
    Setting{"plane_strain", {false, true, false}, {9, 1, 7}},
    Setting{"solids", {false, false, false}, {7, 6, 6}, true},
    Setting{"slope", {false, true, false}, {9, 1, 9}, true});

inline std::string name_of_setting(const ::testing::TestParamInfo<Setting>& instance) {
  return instance.param.name;
}

}  // namespace talus::testing
