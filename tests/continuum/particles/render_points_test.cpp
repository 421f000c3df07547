// Render points: where they are sampled, how they go with the flow, and their normals.
#include "continuum/particles/render_points.h"

#include <gtest/gtest.h>

#include "continuum/particles/move.h"
#include "continuum/particles/sort.h"
#include "continuum/particles/transfer.h"
#include "tests/continuum/particles/render_point_specimens.h"

namespace talus {
namespace {

using namespace testing;  // NOLINT(google-build-using-namespace)

TEST(RenderPoints, AreUniformInTheirParentsEllipsoid) {
  const Matrix3d shape = oblique(0.3, 0.15, 0.05);
  const Particles particles = one_particle({2.0, 2.0, 2.0}, shape);
  constexpr int count = 40000;
  const RenderPoints drawn = sampled(particles, count);
  ASSERT_EQ(drawn.count(), count);
  Vector3d mean = Vector3d::Zero();
  Matrix3d moment = Matrix3d::Zero();
  std::array<int, 8> in_shell{};  // of equal volumes
  const Parent parent(nowhere, particles, 0);
  for (const Eigen::Vector3f& as_stored : drawn.offsets) {
    const Vector3d offset = as_stored.cast<double>();
    mean += offset / count;
    moment += offset * offset.transpose() / count;
    const double cubed = std::pow(parent.squared_distance(offset), 1.5);
    ASSERT_LT(cubed, 1.0 + 1e-5);
    ++in_shell[std::min<std::size_t>(7, static_cast<std::size_t>(8.0 * cubed))];
  }
  // In the frame in which the ellipsoid is the unit ball: mean 0 of deviation 1/sqrt(5 n), moment 1/5 of about 0.2/sqrt(n).
  const Matrix3d inverse = map_of_ball(shape).inverse();
  EXPECT_LT((inverse * mean).cwiseAbs().maxCoeff(), 4.0 / std::sqrt(5.0 * count));
  EXPECT_LT((inverse * moment * inverse.transpose() - 0.2 * Matrix3d::Identity()).cwiseAbs().maxCoeff(),
            4.0 * 0.2 / std::sqrt(count));
  for (const int shell : in_shell) EXPECT_NEAR(shell, count / 8.0, 4.5 * std::sqrt(count * 7.0 / 64.0));
}

TEST(RenderPoints, AreAsManyAsTheMassIsDue) {
  Particles particles = one_particle({1.0, 2.0, 2.0}, testing::ellipsoid(0.2, 0.2, 0.2));
  for (int p = 0; p < 400; ++p)
    testing::add_particle({2.0, 2.0, 2.0}, 0.00025 * full, testing::ellipsoid(0.1, 0.1, 0.1), particles);
  const RenderPoints drawn = sampled(particles, 10);  // a quarter of a point for each of the small ones
  EXPECT_EQ(points_of(drawn, 0), 10);
  EXPECT_NEAR(static_cast<double>(drawn.count() - 10), 100.0, 4.0 * std::sqrt(400 * 0.25 * 0.75));
}

/// A block of sand inside the domain, and the linear velocity x -> v0 + L x on the faces of its region.
struct LinearFlow {
  Particles particles;
  PointsByCell cells;
  ActiveRegion region;
  Field velocity;

  LinearFlow(const Vector3d& v0, const Matrix3d& gradient) {
    for (int k = 0; k < 12; ++k) {
      for (int j = 0; j < 12; ++j) {
        for (int i = 0; i < 12; ++i)
          testing::add_particle(h * (Vector3d(1.0, 1.0, 1.0) + 0.5 * Vector3d(i + 0.4, j + 0.6, k + 0.5)),
                                0.125 * h * h * h * full, testing::ellipsoid(0.18, 0.16, 0.17), particles);
      }
    }
    cells = points_by_cell(grid, particles.positions);
    region = make_active_region(grid, open_sides, cells);
    velocity = Field::Zero(region.face_count());
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3i n = grid.extent(Grid::nodal_of_face(axis));
      for (int dense = 0; dense < n.prod(); ++dense) {
        const int face =
            region.face_of_dense[static_cast<std::size_t>(axis)][static_cast<std::size_t>(dense)];
        if (face < 0) continue;
        Vector3d at(dense % n[0] + 0.5, dense / n[0] % n[1] + 0.5, dense / (n[0] * n[1]) + 0.5);
        at[axis] -= 0.5;
        velocity[face] = (v0 + gradient * (h * at))[axis];
      }
    }
  }
};

TEST(RenderPoints, MoveExactlyWithALinearFlow) {
  Matrix3d gradient;
  gradient << 0.3, -1.0, 0.2, 0.5, 0.4, -0.7, 0.1, 0.9, -0.6;
  const Vector3d v0(0.5, -0.2, 0.3);
  LinearFlow flow(v0, gradient);
  RenderPoints drawn = sampled(flow.particles, 8.0 * 0.01 / (0.125 * h * h * h));
  const auto before = by_identity(flow.particles, drawn);
  flow.particles.track_origins();
  const double long_dt = 0.1;
  sort_by_cell(flow.cells, flow.particles);
  move_render_points(flow.region, flow.cells, flow.velocity, long_dt, flow.particles, drawn);
  // The particles, as the step moves them.
  advance(flow.region, flow.cells, flow.velocity, flow.velocity, {long_dt, Transfer::flip, 0.0, true},
          materials, flow.particles);
  Eigen::Matrix3Xd centres(3, flow.particles.count());
  centres(Eigen::all, flow.particles.origins.row(0)) = flow.particles.positions;
  hand_over(nowhere, materials, centres, flow.particles, drawn);
  int compared = 0;
  for (const auto& [identity, now] : by_identity(flow.particles, drawn)) {
    const Vector3d old = before.at(identity);
    // Where no weight of the kernel falls beyond the surface.
    if ((old.array() < 1.51 * h + h).any() || (old.array() > 5.49 * h + h).any()) continue;
    EXPECT_LT((now - (old + long_dt * (v0 + gradient * old))).norm(), 2e-6) << identity;
    ++compared;
  }
  EXPECT_GT(compared, 1000);
}

TEST(RenderPoints, KeepTheirDistanceInAShapeThatFollowsALinearFlow) {
  Matrix3d gradient;
  gradient << 0.3, -1.0, 0.2, 0.5, 0.1, -0.7, 0.1, 0.9, -0.4;
  LinearFlow flow(Vector3d::Zero(), gradient);
  RenderPoints drawn = sampled(flow.particles, 8.0 * 0.01 / (0.125 * h * h * h));
  flow.particles.track_origins();
  sort_by_cell(flow.cells, flow.particles);
  const auto inside = [&](Eigen::Index p) {
    const auto at = flow.particles.positions.col(p).array();
    return (at > 3.1 * h).all() && (at < 4.9 * h).all();
  };
  const auto distances = [&] {
    std::vector<double> found;
    for (Eigen::Index p = 0; p < flow.particles.count(); ++p) {
      if (!inside(p)) continue;
      const Parent parent(nowhere, flow.particles, p);
      const auto owner = static_cast<std::size_t>(flow.particles.origins(0, p));
      for (auto k = drawn.first[owner]; k < drawn.first[owner + 1]; ++k)
        found.push_back(parent.squared_distance(drawn.offsets[static_cast<std::size_t>(k)].cast<double>()));
    }
    return found;
  };
  const std::vector<double> before = distances();
  ASSERT_GT(before.size(), 100u);
  move_render_points(flow.region, flow.cells, flow.velocity, 0.1, flow.particles, drawn);
  const Eigen::Matrix3Xd positions = flow.particles.positions;
  advance(flow.region, flow.cells, flow.velocity, flow.velocity, {0.1, Transfer::flip, 0.0, true}, materials,
          flow.particles);
  flow.particles.positions = positions;  // so that the same particles are inside
  const std::vector<double> after = distances();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(after[i], before[i], 1e-5);
}

TEST(RenderPoints, StayOutOfWalls) {
  DomainSides corner{};
  corner[0][0] = corner[2][0] = {true, 0.5};
  const Vector3d normal = Vector3d(-0.5, 0.0, 1.0).normalized();  // of a slope through the corner
  const Openings slope = make_openings(grid, [&](const Vector3d& at) {
    return WallDistance{normal.dot(at), 0.5};
  });
  const Surroundings around{grid, corner, slope, nullptr, {}};
  const Matrix3d shape = testing::ellipsoid(0.2, 0.2, 0.2);
  Particles particles = one_particle(Vector3d(2.0, 2.0, 1.0) + 0.05 * normal, shape);
  testing::add_particle({0.15, 2.0, 0.15}, 0.01 * full, shape, particles);
  RenderPoints drawn = sampled(particles, 300, around);
  const auto expect_outside = [&] {
    ASSERT_EQ(drawn.count(), 600);
    for (const auto& [identity, place] : by_identity(particles, drawn)) {
      EXPECT_GE(place.minCoeff(), -1e-6);
      EXPECT_GE(normal.dot(place), -1e-6);
    }
  };
  expect_outside();
  // A little motion into the walls puts points on them, and none is drawn again.
  for (auto& offset : drawn.offsets) offset += (-0.02 * (normal + Vector3d::UnitX())).cast<float>();
  EXPECT_EQ(hand_over_after(
                around, [](Particles&) {}, particles, drawn)
                .resampled,
            0);
  expect_outside();
}

TEST(RenderPoints, HaveTheNormalOfTheSurfaceAndAJitterOfTheirOwn) {
  Block block;
  const RenderPoints drawn = sampled(block.particles, 40 * 0.01 / (0.125 * h * h * h));
  const Field fill = deposit_fill(block.region, block.particles, materials);
  const auto normals = [&](double jitter) {
    return render_normals(block.region, open_sides, no_openings, fill, block.particles, drawn, jitter);
  };
  const Eigen::Matrix3Xf positions = render_positions(grid, block.particles, drawn), smooth = normals(0.0),
                         rough = normals(default_normal_jitter);
  EXPECT_EQ(rough, normals(default_normal_jitter));
  int on_top = 0;
  double off = 0.0;
  for (std::int64_t k = 0; k < drawn.count(); ++k) {
    EXPECT_NEAR(rough.col(k).norm(), 1.0f, 1e-5f);
    const Vector3d at = positions.col(k).cast<double>() / h;
    if (at[2] < 6.5 || (at.head<2>().array() < 3.5).any() || (at.head<2>().array() > 4.5).any()) continue;
    ++on_top;
    EXPECT_GT(smooth(2, k), 0.9999f);
    EXPECT_GT(rough(2, k), 0.7f);
    off += std::acos(std::min(1.0f, rough(2, k)));
  }
  EXPECT_GT(on_top, 100);
  EXPECT_GT(off / on_top, 0.1);  // rad
  // On a floor the sand goes on.
  DomainSides walls{};
  walls[2][0] = {true, 0.5};
  Block low;
  low.particles.positions.row(2).array() -= h;
  low.look();
  const Eigen::Matrix3Xf at_floor =
      render_normals(low.region, walls, no_openings, deposit_fill(low.region, low.particles, materials),
                     low.particles, drawn, 0.0);
  for (std::int64_t k = 0; k < drawn.count(); ++k) {
    const Vector3d at = positions.col(k).cast<double>() / h;
    if (at[2] < 1.5) {
      EXPECT_LT(std::abs(at_floor(2, k)), 1e-3f);
    }
  }
}

}  // namespace
}  // namespace talus
