// Ways past solids and through them.
#include "continuum/grid/free_way.h"

#include <gtest/gtest.h>

#include "continuum/solids/wall.h"

namespace talus {
namespace {

using Eigen::Vector3d;

constexpr double h = 0.1;  // m
const Grid grid{{0, 0, 0}, h, {10, 10, 10}, {false, true, false}};

class FreeWay : public ::testing::Test {
 protected:
  // A plate of 1.3 cells across x, up to half the height.
  std::array<Wall, 1> plate_{Wall{Shape{Box{{0.5, 0.5, 0.0}, {0.65 * h, 5.0, 0.5}}}, 0.3}};
  Openings openings_ = openings_of(grid, plate_, 0.0);
  bool is_free(const Vector3d& from, const Vector3d& to) { return is_free_way(grid, openings_, from, to); }
};

TEST_F(FreeWay, IsThereButForSolids) {
  EXPECT_TRUE(is_free({0.3, 0.5, 0.3}, {0.4, 0.5, 0.3}));
  EXPECT_FALSE(is_free({0.4, 0.5, 0.3}, {0.6, 0.5, 0.3})) << "through the plate";
  EXPECT_TRUE(is_free({0.4, 0.5, 0.7}, {0.6, 0.5, 0.7})) << "over it";
  EXPECT_FALSE(is_free({0.4, 0.5, 0.3}, {0.5, 0.5, 0.3})) << "into it";
  EXPECT_FALSE(is_free({0.5, 0.5, 0.3}, {0.5, 0.5, 0.3})) << "no way at all, but in it";
  EXPECT_TRUE(is_free({0.5 - 0.65 * h, 0.5, 0.3}, {0.4, 0.5, 0.3})) << "from its side";
}

TEST_F(FreeWay, GoesOnOverPeriodicEnds) {
  EXPECT_TRUE(is_free({0.4, 0.95, 0.3}, {0.4, 1.05, 0.3}));
  EXPECT_FALSE(is_free({0.4, 0.95, 0.3}, {0.6, 1.05, 0.3}));
}

TEST_F(FreeWay, IsAskedNoFurtherThanItBegins) {
  // From the very edge of the domain, in steps that do not end there.
  EXPECT_TRUE(is_free({0.0, 0.5, 0.0}, {0.01, 0.5, 0.013}));
  EXPECT_TRUE(is_free_way(grid, {}, {0.0, 0.5, 0.0}, {9.0, 0.5, 0.0})) << "without solids nobody looks";
}

}  // namespace
}  // namespace talus
