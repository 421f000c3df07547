// D1 and D2 against their transposes, and against hand-made fields.
#include "continuum/grid/operators.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <random>

#include "continuum/stress/friction.h"
#include "tests/continuum/grid/ragged_region.h"

namespace talus {
namespace {

class Operators : public ::testing::TestWithParam<testing::Setting> {
 protected:
  ActiveRegion ragged_region() { return testing::ragged_region(GetParam(), random_); }
  /// The last value is the null entry.
  Field random_field(Eigen::Index n) {
    Field field = testing::random_field(n, random_);
    field[n - 1] = 0.0;
    return field;
  }
  std::mt19937_64 random_{7};
};

TEST_P(Operators, GradientAndItsTransposeAreAdjoint) {
  const ActiveRegion region = ragged_region();
  const Field p = random_field(region.cell_count() + 1), v = random_field(region.open_faces + 1);
  Field gradient = Field::Zero(v.size()), divergence = Field::Zero(p.size());
  add_gradient(region, p, 1.0, gradient);
  gradient_transpose(region, v, divergence);
  EXPECT_NEAR((gradient * v).sum(), (p * divergence).sum(), 1e-12 * gradient.abs().sum());
  EXPECT_GT(gradient.abs().sum(), 0.0);
}

TEST_P(Operators, StressDivergenceAndItsTransposeAreAdjoint) {
  const ActiveRegion region = ragged_region();
  StressField stress = make_stress_field(region), strain = make_stress_field(region);
  stress.shear = random_field(region.edge_count() + 1);
  for (int axis = 0; axis < 3; ++axis)
    stress.diagonal.row(axis) = random_field(region.cell_count() + 1).transpose();
  const Field v = random_field(region.open_faces + 1);
  Field force = Field::Zero(v.size());
  add_stress_divergence(region, stress, force);
  stress_divergence_transpose(region, v, strain);
  const double conjugate = (stress.diagonal * strain.diagonal).sum() + (stress.shear * strain.shear).sum();
  EXPECT_NEAR((force * v).sum(), conjugate, 1e-12 * force.abs().sum());
}

TEST_P(Operators, FrictionOperatorAndItsTransposeAreAdjoint) {
  const ActiveRegion region = ragged_region();
  const FrictionOperator friction(region);
  const Field v = random_field(region.open_faces + 1);
  const BallBlocks balls = friction.blocks(Field::Ones(v.size()));
  Eigen::ArrayXd copies = random_field(balls.values() + 1).head(balls.values()), strain(balls.values());
  Field force = Field::Zero(v.size());
  friction.apply(copies, force);
  friction.apply_transpose(v, strain);
  // Components without an edge act on nothing and feel nothing.
  Eigen::ArrayXd used = copies;
  friction.clear_idle(used);
  EXPECT_NEAR((force * v).sum(), (used * strain).sum(), 1e-12 * force.abs().sum());
}

TEST_P(Operators, InnerEdgesExchangeMomentumBetweenTheirFacesAndCreateNone) {
  const ActiveRegion region = ragged_region();
  ASSERT_GT(region.inner_edges, 0);
  StressField stress = make_stress_field(region);
  stress.shear.head(region.inner_edges).setOnes();
  Field force = Field::Zero(region.open_faces + 1);
  add_stress_divergence(region, stress, force);
  EXPECT_NEAR(force.sum(), 0.0, 1e-12);
  EXPECT_GT(force.abs().sum(), 0.0);
}

TEST_P(Operators, EachEdgeIsTouchedByOneCopyOfEachCellAroundIt) {
  const ActiveRegion region = ragged_region();
  std::vector<int> touches(static_cast<std::size_t>(region.edge_count()) + 1, 0), cells(touches);
  for (std::size_t cell = 0; cell < region.cell_edges.size(); ++cell) {
    for (const int edge : region.cell_edges[cell]) ++cells[static_cast<std::size_t>(edge)];
  }
  for (int edge = 0; edge < region.inner_edges; ++edge) {
    for (const int copy : region.edge_copies[static_cast<std::size_t>(edge)])
      touches[static_cast<std::size_t>(edge)] += copy >= 0;
    EXPECT_EQ(touches[static_cast<std::size_t>(edge)], cells[static_cast<std::size_t>(edge)]);
    EXPECT_GE(touches[static_cast<std::size_t>(edge)], 2);
  }
}

TEST_P(Operators, StressWithinTheSandPushesSolidsAlongTheirNormalsOnly) {
  // By the transpose: a rigid slip along every wall strains nothing. On one plane that is a uniform velocity.
  const Grid grid{Eigen::Vector3d::Zero(), 0.5, {8, 8, 8}, {false, false, false}};
  const Eigen::Vector3d normal = Eigen::Vector3d(1.0, 0.6, 1.7).normalized(), slip = normal.unitOrthogonal();
  const Openings openings = make_openings(grid, [&](const Eigen::Vector3d& x) {
    return WallDistance{(x.array() - 1.7).matrix().dot(normal), 0.3};
  });
  Eigen::Matrix3Xd positions(3, grid.cells.prod());
  for (int c = 0; c < grid.cells.prod(); ++c)
    positions.col(c) = 0.5 * (grid.cell_of_index(c).cast<double>().array() + 0.5).matrix();
  const ActiveRegion region = make_active_region(grid, {}, positions, openings);
  ASSERT_GT(region.contacts.size(), 20u);
  ASSERT_GT(region.closures.size(), 20u);
  Field velocity = Field::Zero(region.open_faces + 1), divergence = Field::Zero(region.cell_count() + 1);
  for (int face = 0; face < region.open_faces; ++face)
    velocity[face] = slip[region.face_axis[static_cast<std::size_t>(face)]];
  StressField strain = make_stress_field(region);
  stress_divergence_transpose(region, velocity, strain);
  gradient_transpose(region, velocity, divergence);
  const auto inner = [&](int cell) { return region.cell_share[cell] > 0.0; };
  for (int cell = 0; cell < region.cell_count(); ++cell) {
    if (!inner(cell)) continue;
    EXPECT_LT(strain.diagonal.col(cell).abs().maxCoeff(), 1e-12);
    EXPECT_NEAR(divergence[cell], 0.0, 1e-3);  // but for faces below smallest_opening
  }
  EXPECT_LT(strain.shear.head(region.inner_edges).abs().maxCoeff(), 1e-12);
  EXPECT_GT(strain.contact.abs().maxCoeff(), 0.5);
}

INSTANTIATE_TEST_SUITE_P(Settings, Operators, testing::ragged_settings, testing::name_of_setting);

}  // namespace
}  // namespace talus
