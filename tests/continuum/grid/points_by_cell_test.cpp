// Points by cell, and the map that finds a cell.
#include "continuum/grid/points_by_cell.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace talus {
namespace {

TEST(PointsByCell, HoldsEachPointInItsCellInOrder) {
  const Grid grid{Eigen::Vector3d(-1.0, 0.5, 2.0), 0.25, {40, 30, 20}, {false, false, false}};
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0.0, 1.5);
  Eigen::Matrix3Xd positions(3, 5000);
  for (double& x : positions.reshaped()) x = 3.0 + normal(random);
  std::map<int, std::vector<int>> expected;
  for (int p = 0; p < positions.cols(); ++p) {
    if (grid.contains(positions.col(p)))
      expected[grid.cell_index(grid.cell_at(positions.col(p)))].push_back(p);
  }
  ASSERT_GT(expected.size(), 500u);
  ASSERT_LT(expected.size(), 4000u);
  const PointsByCell points = points_by_cell(grid, positions);
  ASSERT_EQ(points.cells.size(), expected.size());
  std::size_t c = 0;
  for (const auto& [dense, members] : expected) {
    EXPECT_EQ(points.cells[c], dense);
    EXPECT_EQ(points.cell_of_dense[static_cast<std::size_t>(dense)], static_cast<int>(c));
    std::vector<int> found;
    for (int place = points.first[c]; place < points.first[c + 1]; ++place)
      found.push_back(points.point(place));
    EXPECT_EQ(found, members);
    ++c;
  }
  int empty = 0;
  for (int dense = 0; dense < grid.cells.prod(); ++dense)
    empty += points.cell_of_dense[static_cast<std::size_t>(dense)] == -1;
  EXPECT_EQ(empty, grid.cells.prod() - points.cell_count());
}

TEST(PointsByCell, OfNoPointsIsEmpty) {
  const Grid grid{Eigen::Vector3d::Zero(), 1.0, {3, 3, 3}, {false, false, false}};
  const PointsByCell points = points_by_cell(grid, Eigen::Matrix3Xd(3, 0));
  EXPECT_EQ(points.cell_count(), 0);
  EXPECT_EQ(points.point_count(), 0);
}

}  // namespace
}  // namespace talus
