// Which wall is nearest, and when gates open.
#include "continuum/solids/wall.h"

#include <gtest/gtest.h>

namespace talus {
namespace {

using Eigen::Vector3d;

constexpr double never = std::numeric_limits<double>::infinity();

const Wall floor_wall{Shape{Plane{{0, 0, 0}, Vector3d::UnitZ()}}, 0.3};
const Wall gate{Shape{Box{{0, 0, 1}, {1, 1, 0.1}}}, 0.7, 2.0};
const Wall later_gate{Shape{Box{{5, 0, 1}, {1, 1, 0.1}}}, as_rough_as_sand, 3.0};

TEST(Wall, TheNearestGivesDistanceAndFriction) {
  const std::array walls{floor_wall, gate, later_gate};
  const auto near_floor = nearest_wall(walls, 0.0, {0, 0, 0.2});
  EXPECT_DOUBLE_EQ(near_floor.distance, 0.2);
  EXPECT_EQ(near_floor.friction, 0.3);
  const auto near_gate = nearest_wall(walls, 0.0, {0, 0, 0.7});
  EXPECT_DOUBLE_EQ(near_gate.distance, 0.2);
  EXPECT_EQ(near_gate.friction, 0.7);
  EXPECT_EQ(nearest_wall(walls, 0.0, {5, 0, 1.2}).friction, as_rough_as_sand);
  EXPECT_NEAR(nearest_wall(walls, 0.0, {0, 0, 0.95}).distance, -0.05, 1e-15);  // inside the gate
  EXPECT_EQ(nearest_wall({}, 0.0, {0, 0, 0}).distance, never);
}

TEST(Wall, GatesStandUntilTheyOpen) {
  EXPECT_TRUE(gate.stands_at(0.0));
  EXPECT_TRUE(gate.stands_at(std::nextafter(2.0, 0.0)));
  EXPECT_FALSE(gate.stands_at(2.0));
  EXPECT_TRUE(floor_wall.stands_at(1e300));
  const std::array walls{floor_wall, later_gate, gate};
  EXPECT_DOUBLE_EQ(nearest_wall(walls, 2.0, {0, 0, 0.95}).distance, 0.95);
  EXPECT_EQ(next_opening(walls, 0.0), 2.0);
  EXPECT_EQ(next_opening(walls, 2.0), 3.0);  // one that opens now is no longer to come
  EXPECT_EQ(next_opening(walls, 3.0), never);
  EXPECT_EQ(next_opening({}, 0.0), never);
}

TEST(Wall, OpeningsFollowTheGates) {
  const Grid grid{{-1, -1, 0.5}, 0.1, {20, 20, 10}, {false, false, false}};
  const std::array walls{gate};
  const Openings closed = openings_of(grid, walls, 1.999);
  ASSERT_TRUE(closed.any());
  const double volume = 4.0 * 1.0, plate = 4.0 * 0.2;  // the domain, and the gate across it
  EXPECT_NEAR(closed.cells.sum() * grid.cell_volume(), volume - plate, 0.01 * plate);
  EXPECT_FALSE(openings_of(grid, walls, 2.0).any());
  EXPECT_FALSE(openings_of(grid, {}, 0.0).any());
  // With the floor there is still something when the gate has gone, and the gate's place is open.
  const std::array both{floor_wall, gate};
  EXPECT_EQ(openings_of(grid, both, 2.0).cells.minCoeff(), 1.0);
  EXPECT_EQ(openings_of(grid, both, 0.0).cells.minCoeff(), 0.0);
}

TEST(Wall, AHollowContainerLeavesItsInsideOpen) {
  const Grid grid{{0, 0, 0}, 0.1, {10, 10, 10}, {false, false, false}};
  const std::array walls{Wall{Shape{Box{{0.5, 0.5, 0.5}, {0.3, 0.3, 0.3}}, true}, 0.2}};
  const Openings openings = openings_of(grid, walls, 0.0);
  for (int dense = 0; dense < 1000; ++dense) {
    const Eigen::Vector3i i = grid.cell_of_index(dense);
    const bool inside = (i.array() >= 2).all() && (i.array() < 8).all();
    // At the container's edges the interpolated corner is cut.
    const bool at_edge = ((i.array() == 1) || (i.array() == 8)).any();
    if (!inside && at_edge) continue;
    // So is a little of what is inside, where two or three of its walls meet.
    const int walls_beside = static_cast<int>(((i.array() == 2) || (i.array() == 7)).count());
    EXPECT_NEAR(openings.cell_share(dense), inside ? 1.0 : 0.0, walls_beside < 2 ? 1e-12 : 0.05)
        << i.transpose();
  }
  EXPECT_NEAR(nearest_wall(walls, 0.0, {0.5, 0.5, 0.3}).distance, 0.1, 1e-15);
  EXPECT_NEAR(nearest_wall(walls, 0.0, {0.5, 0.5, 0.1}).distance, -0.1, 1e-15);
}

}  // namespace
}  // namespace talus
