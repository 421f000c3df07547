// What tests of render points are made of: single particles with many points, and a block of sand.
#pragma once

#include <gtest/gtest.h>

#include <map>

#include "continuum/particles/render_point_places.h"
#include "continuum/particles/render_points.h"
#include "tests/continuum/particles/particle_sums.h"

namespace talus::testing {

using Eigen::Matrix3d;
using Eigen::Vector3d;

inline constexpr double h = 0.5;
inline const Grid grid{Vector3d::Zero(), h, {8, 8, 8}, {false, false, false}};
inline const DomainSides open_sides{};
inline const Openings no_openings{};
inline const Surroundings nowhere{grid, open_sides, no_openings, nullptr, {}};
inline const std::vector<Material> materials{{"sand", 2500.0, 0.6, 0.5, {}}};
inline const double full = materials[0].max_density();  // kg/m^3
inline constexpr double dt = 0.01;

inline const auto everywhere = [](const Vector3d&, const Vector3d&) { return true; };

inline Matrix3d oblique(double a, double b, double c) {
  const Matrix3d turn = (Eigen::AngleAxisd(0.7, Vector3d(1.0, 2.0, -0.5).normalized())).toRotationMatrix();
  return turn * ellipsoid(a, b, c) * turn.transpose();
}

/// With points in proportion to its mass: `points` of them for 0.01 m^3 of sand.
inline RenderPoints sampled(const Particles& particles, double points, const Surroundings& around = nowhere) {
  return sample_render_points(around, materials, points / 0.01, 7, particles);
}

inline Particles one_particle(const Vector3d& at, const Matrix3d& shape, double volume = 0.01) {
  Particles particles;
  add_particle(at, volume * full, shape, particles);
  return particles;
}

/// Hands over after `change`, which may sort, move, split, merge or remove.
template <class Change>
HandOverReport hand_over_after(const Surroundings& around, const Change& change, Particles& particles,
                               RenderPoints& drawn) {
  const Eigen::Matrix3Xd centres = particles.positions;
  particles.track_origins();
  change(particles);
  const HandOverReport report = hand_over(around, materials, centres, particles, drawn);
  particles.origins.resize(2, 0);
  return report;
}

inline std::map<std::uint32_t, Vector3d> by_identity(const Particles& particles, const RenderPoints& drawn,
                                                     const Grid& in = grid) {
  const Eigen::Matrix3Xf positions = render_positions(in, particles, drawn);
  std::map<std::uint32_t, Vector3d> places;
  for (std::int64_t k = 0; k < drawn.count(); ++k)
    places[drawn.identities[static_cast<std::size_t>(k)]] = positions.col(k).cast<double>();
  EXPECT_EQ(static_cast<std::int64_t>(places.size()), drawn.count()) << "an identity is there twice";
  return places;
}

inline std::int64_t points_of(const RenderPoints& drawn, std::size_t p) {
  return drawn.first[p + 1] - drawn.first[p];
}

/// Sand of 2 x 2 x 2 particles a cell in a block of 6^3 cells; the fill of its cells as given.
struct Block {
  Particles particles;
  ActiveRegion region;
  Field fill;

  Block() {
    for (int k = 0; k < 12; ++k) {
      for (int j = 0; j < 12; ++j) {
        for (int i = 0; i < 12; ++i)
          add_particle(h * (Vector3d(1.0, 1.0, 1.0) + 0.5 * Vector3d(i + 0.5, j + 0.5, k + 0.5)),
                       0.125 * h * h * h * full, sphere_of_volume(0.125 * h * h * h), particles);
      }
    }
    look();
  }
  void look() {
    region = make_active_region(grid, open_sides, particles.positions);
    fill = Field::Zero(region.cell_count() + 1);
    fill.head(region.cell_count()).setConstant(0.95);
  }
  int cell(int x, int y, int z) const {
    return region.cell_of_dense[static_cast<std::size_t>(grid.cell_index({x, y, z}))];
  }
  /// How many particles of the 8 of a cell have points.
  std::int64_t shown(const RenderPoints& drawn, int x, int y, int z) const {
    std::int64_t count = 0;
    for (Eigen::Index p = 0; p < particles.count(); ++p) {
      if (grid.cell_at(particles.positions.col(p)) == Eigen::Vector3i(x, y, z))
        count += points_of(drawn, static_cast<std::size_t>(p)) > 0;
    }
    return count;
  }
};

}  // namespace talus::testing
