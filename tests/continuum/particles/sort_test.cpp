// Sorting by cell: stable, whole, and the same for any number of threads.
#include "continuum/particles/sort.h"

#include <gtest/gtest.h>

#include <random>

#include "continuum/parallel.h"
#include "tests/continuum/particles/particle_sums.h"

namespace talus {
namespace {

const Grid grid{Eigen::Vector3d::Zero(), 0.5, {6, 5, 4}, {false, true, false}};

Particles crowd() {
  Particles particles;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int p = 0; p < 9000; ++p) {
    const Eigen::Vector3d at(3.0 * unit(random), 2.5 * unit(random), 2.0 * unit(random));
    testing::add_particle(at, 1.0 + p, testing::ellipsoid(unit(random), unit(random), unit(random)),
                          particles);
    particles.velocities.col(p) = at.array() + 0.25;
    particles.materials[static_cast<std::size_t>(p)] = p % 7;
    particles.gradients.col(p).setConstant(p);
  }
  return particles;
}

TEST(SortByCell, OrdersByCellKeepsTheOrderWithinAndMovesAllOfAParticle) {
  const Particles before = crowd();
  Particles particles = before;
  PointsByCell points = points_by_cell(grid, particles.positions);
  sort_by_cell(points, particles);
  int last_cell = -1;
  double last = -1.0;
  for (Eigen::Index p = 0; p < particles.count(); ++p) {
    const int cell = grid.cell_index(grid.cell_at(particles.positions.col(p)));
    EXPECT_TRUE(cell > last_cell || (cell == last_cell && particles.masses[p] > last));
    last_cell = cell;
    last = particles.masses[p];
    const auto from = static_cast<Eigen::Index>(last - 1.0);
    EXPECT_EQ(particles.positions.col(p), before.positions.col(from));
    EXPECT_EQ(particles.velocities.col(p), before.velocities.col(from));
    EXPECT_EQ(particles.shapes.col(p), before.shapes.col(from));
    EXPECT_EQ(particles.gradients.col(p), before.gradients.col(from));
    EXPECT_EQ(particles.materials[static_cast<std::size_t>(p)], from % 7);
  }
  // Sorted once, they stay.
  const PointsByCell again = points_by_cell(grid, particles.positions);
  EXPECT_TRUE(again.order.empty());
  EXPECT_EQ(again.cells, points.cells);
  EXPECT_EQ(again.first, points.first);
}

TEST(SortByCell, ThreadsChangeNothing) {
  const auto sorted = [](int threads) {
    set_thread_count(threads);
    Particles particles = crowd();
    PointsByCell points = points_by_cell(grid, particles.positions);
    sort_by_cell(points, particles);
    set_thread_count(1);
    return particles;
  };
  EXPECT_TRUE(testing::identical(sorted(1), sorted(2)));
}

TEST(SortByCell, AParticleOutsideTheDomainIsRefused) {
  Particles particles = crowd();
  particles.positions(2, 17) = 2.5;
  PointsByCell points = points_by_cell(grid, particles.positions);
  EXPECT_EQ(points.point_count(), particles.count() - 1);
  EXPECT_THROW(sort_by_cell(points, particles), std::invalid_argument);
}

}  // namespace
}  // namespace talus
