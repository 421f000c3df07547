#include "dem_cases/packing/packing.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/dem_cases/case_files.h"

namespace talus::dem {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Least gap between any two spheres, with the nearest periodic image across y; pairs of fixed grains left
/// out.
double least_gap(const Packing& packing, double thickness) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = packing.fixed_count; i < packing.count(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      Eigen::Vector3d apart = packing.positions.col(i) - packing.positions.col(j);
      apart.y() -= thickness * std::round(apart.y() / thickness);
      least = std::min(least, apart.norm() - packing.radii[i] - packing.radii[j]);
    }
  }
  return least;
}

class PackingOf : public ::testing::TestWithParam<std::filesystem::path> {};

TEST_P(PackingOf, IsTheSameForASeedAndAnotherForAnother) {
  const Case column = read_case(GetParam());
  const Packing once = make_packing(column, 7), again = make_packing(column, 7),
                other = make_packing(column, 8);
  EXPECT_EQ(once.positions, again.positions);
  EXPECT_EQ(once.velocities, again.velocities);
  EXPECT_EQ(once.radii, again.radii);
  EXPECT_NE(once.radii.head(10), other.radii.head(10));
  EXPECT_NE(once.positions.col(once.fixed_count), other.positions.col(other.fixed_count));
}

TEST_P(PackingOf, HasNoOverlapsEvenAcrossThePeriod) {
  const Case column = read_case(GetParam());
  for (const std::uint64_t seed : column.seeds) {
    EXPECT_GT(least_gap(make_packing(column, seed), column_geometry(column).thickness), 0.0)
        << "seed " << seed;
  }
}

TEST_P(PackingOf, StandsBetweenTheWalls) {
  const Case column = read_case(GetParam());
  const Packing packing = make_packing(column, 1);
  for (Eigen::Index i = 0; i < packing.count(); ++i) {
    const auto position = packing.positions.col(i);
    EXPECT_GE(position.y(), 0.0);
    EXPECT_LT(position.y(), column_geometry(column).thickness);
    EXPECT_GE(packing.radii[i], 0.5 * column.grains.diameter * (1 - column.grains.diameter_spread));
    EXPECT_LE(packing.radii[i], 0.5 * column.grains.diameter * (1 + column.grains.diameter_spread));
    if (i < packing.fixed_count) {
      EXPECT_TRUE(packing.velocities.col(i).isZero(0.0));
    } else {
      EXPECT_GT(position.x() - packing.radii[i], 0.0);
      EXPECT_LT(position.x() + packing.radii[i], column_geometry(column).column_length);
      EXPECT_GT(position.z() - packing.radii[i], 0.0);
    }
  }
}

TEST_P(PackingOf, HasTheSolidVolumeOfTheCaseToHalfAGrain) {
  const Case column = read_case(GetParam());
  const ColumnGeometry& geometry = column_geometry(column);
  const double wanted =
      column.protocol.volume_fraction * geometry.column_length * geometry.column_height * geometry.thickness;
  const double largest =
      std::numbers::pi / 6 * std::pow(column.grains.diameter * (1 + column.grains.diameter_spread), 3);
  EXPECT_NEAR(make_packing(column, 3).mobile_volume(), wanted, 0.5 * largest);
}

TEST_P(PackingOf, FloorHasNoHoleForAGrain) {
  const Case column = read_case(GetParam());
  const Packing packing = make_packing(column, 1);
  const double smallest = 0.5 * column.grains.diameter * (1 - column.grains.diameter_spread);
  for (double x = smallest; x < column_geometry(column).tank_length - smallest;
       x += 0.1 * column.grains.diameter) {
    for (double y = 0.0; y < column_geometry(column).thickness; y += 0.1 * column.grains.diameter) {
      bool blocked = false;
      for (Eigen::Index i = 0; i < packing.fixed_count && !blocked; ++i) {
        double across = y - packing.positions(1, i);
        across -= column_geometry(column).thickness * std::round(across / column_geometry(column).thickness);
        blocked = std::hypot(x - packing.positions(0, i), across) < packing.radii[i] + smallest;
      }
      ASSERT_TRUE(blocked) << "a grain falls through at x = " << x << ", y = " << y;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, PackingOf, ::testing::Values(column_collapse_file, tiny_column_file),
                         [](const auto& instance) {
                           return instance.param == tiny_column_file ? "tiny_column" : "column_collapse";
                         });

// Pinned, so that a change of the generator does not pass for a change of the physics.
TEST(Packing, IsTheOneThatResultsWereMadeWith) {
  const Packing packing = make_packing(read_case(column_collapse_file), 1);
  EXPECT_EQ(packing.fixed_count, 320);
  EXPECT_EQ(packing.mobile_count(), 1072);
  EXPECT_DOUBLE_EQ(packing.radii[packing.fixed_count], 0.0014281937128255424);
  EXPECT_DOUBLE_EQ(packing.positions(0, packing.count() - 1), 0.024183488968674036);
}

TEST(Packing, FlatFloorHasNoFixedGrains) {
  Case column = read_case(tiny_column_file);
  column_geometry(column).rough_floor = false;
  const Packing packing = make_packing(column, 1);
  EXPECT_EQ(packing.fixed_count, 0);
  EXPECT_GT((packing.positions.row(2).transpose() - packing.radii).minCoeff(), 0.0);
}

TEST(Packing, SaysWhenThereIsNoRoom) {
  Case column = read_case(tiny_column_file);
  column_geometry(column).thickness = column.grains.diameter;
  EXPECT_THAT(input_error([&] { make_packing(column, 1); }),
              AllOf(HasSubstr("tiny_column.toml"), HasSubstr("thickness_m")));
}

}  // namespace
}  // namespace talus::dem
