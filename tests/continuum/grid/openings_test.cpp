// What solids leave open, against plane and sphere geometry that is known exactly.
#include "continuum/grid/openings.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "continuum/particles/transfer.h"
#include "continuum/solids/wall.h"
#include "tests/continuum/particles/particle_sums.h"

namespace talus {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double h = 0.1;  // m

Grid grid_of(const Vector3i& cells) { return {Vector3d(0.3, -0.2, 0.1), h, cells, {false, false, false}}; }

WallDistanceFunction plane(const Vector3d& point, const Vector3d& normal, double friction = 0.4) {
  return [=](const Vector3d& x) { return WallDistance{normal.normalized().dot(x - point), friction}; };
}

template <class Function>
void for_each_cell(const Grid& grid, Function&& f) {
  for (int dense = 0; dense < grid.cells.prod(); ++dense) f(grid.cell_of_index(dense));
}

/// W of openings.h, h^2.
Vector3d wall_area(const Grid& grid, const Openings& openings, const Vector3i& cell) {
  Vector3d area;
  for (int axis = 0; axis < 3; ++axis)
    area[axis] = openings.face_share(axis, grid.face_index(axis, cell + Vector3i::Unit(axis))) -
                 openings.face_share(axis, grid.face_index(axis, cell));
  return area;
}

TEST(PositiveShare, IsExactForLinearFunctions) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto ramp_squared = [](double value) { return value > 0.0 ? value * value : 0.0; };
  int cut = 0;
  for (int i = 0; i < 5000; ++i) {
    const double a = unit(random), b = unit(random), c = unit(random);
    // The second difference of (c + a x + b y)^2 / 2 where positive integrates its Heaviside function twice.
    const double exact =
        (ramp_squared(c + a + b) - ramp_squared(c + a) - ramp_squared(c + b) + ramp_squared(c)) /
        (2.0 * a * b);
    const double share = positive_share({c, c + a, c + a + b, c + b});
    EXPECT_NEAR(share, exact, 1e-12 / std::abs(a * b)) << a << ' ' << b << ' ' << c;
    EXPECT_NEAR(share + positive_share({-c, -c - a, -c - a - b, -c - b}), 1.0, 1e-13);
    cut += share > 0.0 && share < 1.0;
  }
  EXPECT_GT(cut, 1000);
}

// At the ledge of the pile-angle case z = 0 lay 1.4e-17 m above the grid's plane: the plane was open, and the bed slid on it.
TEST(Openings, AWallAlongTheGridsPlanesClosesThemWhateverTheRoundOff) {
  int rounded_up = 0;
  for (const double spacing : {0.003, 0.0024, 0.0015, 0.1, 0.007}) {
    double depth = 2.0 * spacing;  // added up, so that it rounds otherwise than a product
    for (int below = 3; below < 60; ++below) {
      depth += spacing;
      const Grid grid{Vector3d(0.0, 0.0, -depth), spacing, {2, 2, below + 2}, {false, false, false}};
      const auto openings = make_openings(grid, plane({0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}));
      rounded_up += grid.origin.z() + spacing * below > 0.0;
      EXPECT_EQ(openings.face_share(2, grid.face_index(2, {0, 0, below})), 0.0) << spacing << ' ' << below;
      EXPECT_EQ(openings.cell_share(grid.cell_index({0, 0, below - 1})), 0.0);
      EXPECT_NEAR(openings.cell_share(grid.cell_index({0, 0, below})), 1.0, 1e-9);
      EXPECT_NEAR(wall_area(grid, openings, {0, 0, below}).z(), 1.0, 1e-9);
    }
  }
  EXPECT_GT(rounded_up, 10);
}

TEST(PositiveShare, CasesKnownByHand) {
  EXPECT_EQ(positive_share({1, 1, 1, 1}), 1.0);
  EXPECT_EQ(positive_share({-1, -1, -1, -1}), 0.0);
  EXPECT_EQ(positive_share({0, 0, 0, 0}), 0.0);
  EXPECT_DOUBLE_EQ(positive_share({0, 0, 1, 1}), 1.0);  // an edge on the wall
  EXPECT_DOUBLE_EQ(positive_share({0, 0, -1, -1}), 0.0);
  EXPECT_DOUBLE_EQ(positive_share({0, 1, 0, -1}), 0.5);  // a diagonal
  EXPECT_DOUBLE_EQ(positive_share({3, -1, -1, 3}), 0.75);
  EXPECT_DOUBLE_EQ(positive_share({1, -1, -3, -1}), 0.125);  // one corner
  EXPECT_DOUBLE_EQ(positive_share({-1, 1, 3, 1}), 0.875);
}

TEST(Openings, WithoutSolidsEverythingIsOpen) {
  const Openings none;
  EXPECT_FALSE(none.any());
  for (int i : {0, 7}) {
    EXPECT_EQ(none.cell_share(i), 1.0);
    EXPECT_EQ(none.cell_kernel_share(i), 1.0);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(none.face_share(axis, i), 1.0);
      EXPECT_EQ(none.face_kernel_share(axis, i), 1.0);
    }
  }
}

TEST(Openings, AWallOutOfReachClosesNothing) {
  const Grid grid = grid_of({4, 3, 5});
  const Openings openings = make_openings(grid, plane(grid.origin - Vector3d(0, 0, 1), Vector3d::UnitZ()));
  EXPECT_TRUE(openings.any());
  EXPECT_EQ((openings.cells - 1.0).abs().maxCoeff(), 0.0);
  EXPECT_LT((openings.cell_kernel - 1.0).abs().maxCoeff(), 1e-12);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_EQ((openings.faces[axis] - 1.0).abs().maxCoeff(), 0.0);
    // Faces on the domain's sides have half a kernel.
    EXPECT_LT((openings.face_kernel[axis] - 1.0).max(-0.5).abs().maxCoeff(), 0.5 + 1e-12);
  }
}

TEST(Openings, WallOfATiltedPlaneHasItsAreaAndItsNormal) {
  const Grid grid = grid_of({7, 6, 12});
  const Vector3d normal = Vector3d(1.0, -2.0, 5.0).normalized();
  const Openings openings = make_openings(grid, plane(grid.origin + h * Vector3d(3.5, 3.1, 6.3), normal));
  double area = 0.0;
  int cut = 0;
  for_each_cell(grid, [&](const Vector3i& cell) {
    const Vector3d wall = wall_area(grid, openings, cell);
    area += wall.norm();
    cut += wall.norm() > 0.0;
    EXPECT_LT((wall - wall.norm() * normal).norm(), 1e-10) << cell.transpose();
  });
  // The plane leaves the domain through its upright sides only.
  EXPECT_NEAR(area, 7 * 6 / normal[2], 1e-10);
  EXPECT_GT(cut, 42);
}

TEST(Openings, FaceShareIsThatOfTheFaceItself) {
  // z > 1.25 h: a face normal to x is open from a quarter of its height.
  const Grid grid = grid_of({2, 2, 3});
  const Openings openings =
      make_openings(grid, plane(grid.origin + h * Vector3d(0, 0, 1.25), Vector3d::UnitZ()));
  for (int axis = 0; axis < 3; ++axis) {
    const auto share = [&](int k) { return openings.face_share(axis, grid.face_index(axis, {1, 1, k})); };
    EXPECT_EQ(share(0), 0.0) << axis;
    EXPECT_NEAR(share(1), axis == 2 ? 0.0 : 0.75, 1e-12) << axis;
    EXPECT_NEAR(share(2), 1.0, 1e-12) << axis;
  }
  EXPECT_EQ(openings.cell_share(grid.cell_index({1, 1, 0})), 0.0);
  EXPECT_NEAR(openings.cell_share(grid.cell_index({1, 1, 1})), 0.75, 1e-12);
  EXPECT_EQ(openings.friction[grid.cell_index({1, 1, 1})], 0.4);
}

TEST(Openings, VolumeAroundAndInsideASphere) {
  const Grid grid = grid_of({10, 11, 12});
  const Vector3d centre = grid.origin + h * Vector3d(5.1, 5.4, 6.2);
  for (const double radius : {2.1, 3.7, 4.9}) {  // h
    const double volume = 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3);
    for (const bool hollow : {false, true}) {
      const Wall wall{Shape{Sphere{centre, h * radius}, hollow}, 0.4};
      const Openings openings = openings_of(grid, std::array{wall}, 0.0);
      const double open = openings.cells.sum(), expected = hollow ? volume : grid.cells.prod() - volume;
      // Chords cut off what bulges: the interpolant makes the ball smaller, by about h^2 / 6 r.
      const double error = (open - expected) / volume * (hollow ? -1.0 : 1.0) * radius * radius;
      EXPECT_GT(error, 0.4) << radius << hollow;
      EXPECT_LT(error, 0.6) << radius << hollow;
    }
  }
}

TEST(Openings, DistanceAndGradientAreExactForPlanes) {
  const Grid grid = grid_of({5, 4, 6});
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const Vector3d& normal : {Vector3d(0, 0, 1), Vector3d(1, -2, 3), Vector3d(-0.3, 1, 0.2)}) {
    const auto wall = plane(grid.origin + h * Vector3d(2.2, 2, 2.9), normal);
    const Openings openings = make_openings(grid, wall);
    for (int i = 0; i < 200; ++i) {
      const Vector3d at =
          grid.origin +
          (grid.upper() - grid.origin).cwiseProduct(Vector3d(unit(random), unit(random), unit(random)));
      const auto [distance, gradient] = distance_at(grid, openings, at);
      EXPECT_NEAR(distance, wall(at).distance, 1e-14);
      EXPECT_LT((gradient - normal.normalized()).norm(), 1e-12);
    }
  }
}

/// Largest deviation from 1 of the fill that sand at its packing limit deposits where the wall leaves space, over cells
/// whose kernel is open by a quarter at least.
double worst_fill(const WallDistanceFunction& wall) {
  constexpr int per_axis = 16;
  const Grid grid = grid_of({5, 3, 5});
  const std::vector<Material> materials{{"sand", 2500.0, 0.6, 0.5, {}}};
  const double spacing = h / per_axis, mass = materials[0].max_density() * spacing * spacing * spacing;
  Particles particles;
  std::vector<Vector3d> positions;
  for_each_cell({grid.origin, spacing, per_axis * grid.cells, {false, false, false}}, [&](const Vector3i& i) {
    const Vector3d at = grid.origin + spacing * (i.cast<double>().array() + 0.5).matrix();
    if (wall(at).distance > 0.0) positions.push_back(at);
  });
  particles.resize(static_cast<Eigen::Index>(positions.size()));
  for (std::size_t p = 0; p < positions.size(); ++p)
    particles.positions.col(static_cast<Eigen::Index>(p)) = positions[p];
  particles.masses.setConstant(mass);
  particles.velocities.setZero();
  const Openings openings = make_openings(grid, wall);
  const ActiveRegion region = make_active_region(grid, {}, particles.positions, openings);
  const GridState state =
      deposit(region, particles, materials, Eigen::ArrayXd::Constant(particles.count(), 0.5));
  double worst = 0.0;
  int beside = 0;
  for (int cell = 0; cell < region.cell_count(); ++cell) {
    const double share = openings.cell_kernel_share(region.dense_of_cell[static_cast<std::size_t>(cell)]);
    if (share < 0.25) continue;
    beside += share < 1.0 - 1e-9;
    worst = std::max(worst, std::abs(state.fill[cell] - 1.0));
  }
  EXPECT_GT(beside, 2);
  return worst;
}

TEST(Openings, PackedSandHasFillOneBesideAWall) {
  const Vector3d corner = grid_of({1, 1, 1}).origin;
  for (const double offset : {0.0625, 0.25, 0.4375, 0.625, 0.8125}) {
    // On whole sixteenths of a cell the lattice has exactly the free volume; beside tilted planes its grain shows.
    const Vector3d point = corner + h * Vector3d(0, 0, 1.0 + offset);
    EXPECT_LT(worst_fill(plane(point, Vector3d::UnitZ())), 0.02 + 1e-12) << offset;
    EXPECT_LT(worst_fill(plane(point, Vector3d(1, 0, 2))), 0.05) << offset;
    EXPECT_LT(worst_fill(plane(point, Vector3d(1, 1, 1))), 0.05) << offset;
  }
}

}  // namespace
}  // namespace talus
