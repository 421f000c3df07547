// D1 and D2 against their transposes, and against hand-made fields.
#include "continuum/grid/operators.h"

#include <gtest/gtest.h>

#include <random>

#include "continuum/stress/friction.h"

namespace talus {
namespace {

struct Setting {
  const char* name;
  std::array<bool, 3> periodic;
  Eigen::Vector3i cells;
};

void PrintTo(const Setting& setting, std::ostream* out) { *out << setting.name; }

class Operators : public ::testing::TestWithParam<Setting> {
 protected:
  /// A ragged cloud of particles: active cells with holes, against the walls here and there.
  ActiveRegion ragged_region() {
    const Setting& setting = GetParam();
    const Grid grid{Eigen::Vector3d::Zero(), 0.5, setting.cells, setting.periodic};
    DomainSides sides;
    for (auto& axis : sides) axis = {Side{true, 0.4}, Side{true, 0.0}};
    const int n = grid.cells.prod();
    Eigen::Matrix3Xd positions(3, n);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int p = 0; p < n; ++p) {
      for (int axis = 0; axis < 3; ++axis) positions(axis, p) = 0.5 * grid.cells[axis] * unit(random_);
    }
    return make_active_region(grid, sides, positions);
  }
  Field random_field(Eigen::Index n) {
    std::normal_distribution<double> normal;
    Field field(n);
    for (double& value : field) value = normal(random_);
    field[n - 1] = 0.0;  // the null entry
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

INSTANTIATE_TEST_SUITE_P(Settings, Operators,
                         ::testing::Values(Setting{"box", {false, false, false}, {5, 6, 4}},
                                           Setting{"periodic", {true, true, true}, {4, 6, 4}},
                                           Setting{"plane_strain", {false, true, false}, {9, 1, 7}}),
                         [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace talus
