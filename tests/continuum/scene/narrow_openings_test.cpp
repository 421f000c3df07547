// Openings that the grid is too coarse for: found with their width, whatever makes them and wherever they lie on the grid.
#include "continuum/scene/narrow_openings.h"

#include <gmock/gmock.h>

#include <cmath>

namespace talus {
namespace {

using Eigen::Vector3d;

constexpr double h = 0.01;
const DomainSides all_open{};

Shape box(const Vector3d& lower, const Vector3d& upper) {
  return {Box{0.5 * h * (lower + upper), 0.5 * h * (upper - lower)}};  // in cells
}

Grid grid_of(const Eigen::Vector3i& cells) {
  return {Vector3d::Zero(), h, cells, {false, cells[1] == 1, false}};
}

/// A floor 3 cells thick half way up, with a slot of `width` cells from `left`; in plane strain.
std::vector<Wall> slotted_floor(double left, double width) {
  return {{box({-5, -5, 20}, {left, 6, 23}), 0.5}, {box({left + width, -5, 20}, {45, 6, 23}), 0.5}};
}

std::vector<NarrowOpening> found(const Grid& grid, const std::vector<Wall>& walls,
                                 const DomainSides& sides = all_open) {
  return narrow_openings(grid, sides, walls, 6.0 * h);
}

DomainSides closed_sides() {
  DomainSides sides;
  for (const std::size_t axis : {0, 2}) sides[axis] = {Side{true, 0.5}, Side{true, 0.5}};
  return sides;
}

TEST(NarrowOpenings, TellTheWidthOfASlotWhereverItLies) {
  for (const double width : {1.3, 2.0, 3.5, 5.0, 5.9}) {
    for (const double left : {15.0, 15.3, 15.5, 17.77}) {
      const auto openings = found(grid_of({40, 1, 40}), slotted_floor(left, width), closed_sides());
      ASSERT_EQ(openings.size(), 1u) << width << " from " << left;
      EXPECT_NEAR(openings[0].width, width * h, 0.01 * h) << left;
      EXPECT_NEAR(openings[0].place[0], (left + 0.5 * width) * h, 0.5 * h);
    }
  }
}

TEST(NarrowOpenings, AreAlsoGapsThatTheGridCloses) {
  for (const double width : {0.5, 0.7, 0.9}) {
    const auto openings = found(grid_of({40, 1, 40}), slotted_floor(15.05, width), closed_sides());
    ASSERT_EQ(openings.size(), 1u) << width;
    EXPECT_NEAR(openings[0].width, width * h, 0.01 * h);
  }
  EXPECT_TRUE(found(grid_of({40, 1, 40}), slotted_floor(15.05, 0.0), closed_sides()).empty());
}

TEST(NarrowOpenings, AreNotWhatIsWideEnough) {
  for (const double width : {6.0, 6.4, 9.0}) {
    for (const double left : {15.0, 15.3, 15.5}) {
      EXPECT_TRUE(found(grid_of({40, 1, 40}), slotted_floor(left, width), closed_sides()).empty())
          << width << " from " << left;
    }
  }
}

TEST(NarrowOpenings, TellTheNeckOfAnHourglass) {
  for (const double radius : {1.25, 2.0, 2.9, 3.5}) {
    HourglassSize size{10.0 * h, 8.0 * h, radius * h, 2.0 * h, 0.7};
    const Shape glass{hourglass({12.3 * h, 12.0 * h, 1.0 * h}, Vector3d::UnitZ(), size), true};
    const auto openings = found(grid_of({24, 24, 60}), {{glass, 0.5}}, closed_sides());
    if (radius > 3.0) {
      EXPECT_TRUE(openings.empty());
      continue;
    }
    ASSERT_EQ(openings.size(), 1u) << radius;
    EXPECT_NEAR(openings[0].width, 2.0 * radius * h, 0.05 * h);
  }
}

TEST(NarrowOpenings, AreThereBehindGatesAndOutOfTheDomain) {
  auto walls = slotted_floor(18.0, 4.0);
  walls.push_back({box({17, -5, 19}, {23, 6, 24}), 0.5, 0.3});
  EXPECT_EQ(found(grid_of({40, 1, 40}), walls, closed_sides()).size(), 1u);
  // The same floor at the bottom of a domain that is open below.
  const std::vector<Wall> at_bottom{{box({-5, -5, -1}, {18, 6, 3}), 0.5},
                                    {box({22, -5, -1}, {45, 6, 3}), 0.5}};
  DomainSides sides = closed_sides();
  sides[2] = {};
  const auto openings = found(grid_of({40, 1, 40}), at_bottom, sides);
  ASSERT_EQ(openings.size(), 1u);
  EXPECT_NEAR(openings[0].width, 4.0 * h, 0.01 * h);
  EXPECT_LE(openings[0].place[2], 3.0 * h + 1e-12);
}

TEST(NarrowOpenings, AreNotSlantedChannelsRoughWallsOrTheNarrowerOfTwoWays) {
  Box channel{{0.2, 0.005, 0.2}, {1.0, 1.0, 2.0 * h}};  // 4 cells wide, from side to side
  channel.rotation = Eigen::AngleAxisd(0.4, Vector3d::UnitY()).toRotationMatrix();
  EXPECT_TRUE(found(grid_of({40, 1, 40}), {{{channel, true}, 0.5}}, closed_sides()).empty());
  // A post in a duct: 3 cells on one side of it, 12 on the other.
  EXPECT_TRUE(found(grid_of({20, 1, 40}), {{box({3, -5, 18}, {8, 6, 22}), 0.5}}, closed_sides()).empty());
  std::vector<Wall> teeth;
  for (int i = 0; i < 10; ++i) teeth.push_back({box({4.0 * i, -5, 0}, {4.0 * i + 2, 6, 2}), 0.5});
  EXPECT_TRUE(found(grid_of({40, 1, 40}), teeth, closed_sides()).empty());
  EXPECT_TRUE(found(grid_of({40, 1, 40}), {}, closed_sides()).empty());
}

}  // namespace
}  // namespace talus
