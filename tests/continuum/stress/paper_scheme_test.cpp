// Warm starts of the paper scheme, and the choice between the two schemes.
#include "continuum/stress/paper_scheme.h"

#include <gtest/gtest.h>

#include "tests/continuum/scenes.h"

namespace talus {
namespace {

State box_on_a_floor() {
  Scene scene = testing::box_scene({8, 3, 4}, {3.0, 3.0, 2.0}, 0.1, 0.5);
  scene.sides[2][0] = {true, 0.3};
  return initial_state(scene);
}

ActiveRegion region_of(const State& state) {
  return make_active_region(state.grid, state.sides, state.particles.positions);
}

PaperStress numbered_stress(const ActiveRegion& region) {
  PaperStress stress = zero_paper_stress(region);
  const auto number = [](Eigen::Index n) { return Field::LinSpaced(n, 1.0, static_cast<double>(n)); };
  stress.pressure.head(region.cell_count()) = number(region.cell_count());
  for (int axis = 0; axis < 3; ++axis)
    stress.friction.diagonal.row(axis).head(region.cell_count()) = number(region.cell_count()).transpose();
  stress.friction.shear.head(region.edge_count()) = number(region.edge_count());
  return stress;
}

TEST(PaperWarmStart, CarriesCellsAndEdgesScaledWithTheTimeStep) {
  const ActiveRegion from = region_of(box_on_a_floor()), to = region_of(box_on_a_floor());
  ASSERT_GT(from.edge_count(), from.inner_edges);  // wall edges too
  const PaperStress stress = numbered_stress(from), carried = carry_over(from, stress, to, 0.5);
  EXPECT_EQ((carried.pressure - 0.5 * stress.pressure).abs().maxCoeff(), 0.0);
  EXPECT_EQ((carried.friction.diagonal - 0.5 * stress.friction.diagonal).abs().maxCoeff(), 0.0);
  EXPECT_EQ((carried.friction.shear - 0.5 * stress.friction.shear).abs().maxCoeff(), 0.0);
}

TEST(PaperWarmStart, NewCellsAndEdgesStartFromZeroAndOldOnesStayWhereTheyAre) {
  State state = box_on_a_floor();
  const ActiveRegion from = region_of(state);
  state.particles.positions.row(0).array() += 0.1;  // one cell on
  const ActiveRegion to = region_of(state);
  const PaperStress stress = numbered_stress(from), carried = carry_over(from, stress, to, 1.0);
  int kept = 0, fresh = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t dense = 0; dense < to.edge_of_dense[axis].size(); ++dense) {
      const int now = to.edge_of_dense[axis][dense], before = from.edge_of_dense[axis][dense];
      if (now < 0) continue;
      EXPECT_EQ(carried.friction.shear[now], before < 0 ? 0.0 : stress.friction.shear[before]);
      ++(before < 0 ? fresh : kept);
    }
  }
  EXPECT_GT(kept, 0);
  EXPECT_GT(fresh, 0);
  EXPECT_EQ((carried.pressure > 0.0).count(), from.cell_count() * 2 / 3);
  EXPECT_EQ(carried.friction.shear[to.null_edge()], 0.0);
}

TEST(SchemeChoice, AStateRunsEitherAndAChangeStartsFromZeroStress) {
  State state = box_on_a_floor();
  StepSettings paper, consistent;
  paper.scheme = Scheme::paper;
  step(state, paper, 1e-3);
  EXPECT_TRUE(std::holds_alternative<PaperStress>(state.warm->stress));
  EXPECT_GT(pressure_of(state.warm->stress).maxCoeff(), 0.0);
  const SchemeStress changed =
      carry_over(Scheme::consistent, state.warm->region, state.warm->stress, state.warm->region, 1.0);
  EXPECT_TRUE(std::holds_alternative<Stress>(changed));
  EXPECT_EQ(pressure_of(changed).maxCoeff(), 0.0);
  step(state, consistent, 1e-3);
  EXPECT_TRUE(std::holds_alternative<Stress>(state.warm->stress));
}

}  // namespace
}  // namespace talus
