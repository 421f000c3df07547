// What carries stress from place to place: the wall's bound, the warm start, the pressure of a single cell.
#include <gtest/gtest.h>

#include "continuum/stress/friction.h"
#include "continuum/stress/paper_scheme.h"
#include "continuum/stress/pressure.h"
#include "tests/continuum/grid/ragged_region.h"
#include "tests/continuum/scenes.h"

namespace talus {
namespace {

ActiveRegion layer_region(int columns) {
  Scene scene = testing::box_scene({columns, 1, 4}, {double(columns), 1.0, 2.0}, 0.1, 0.5);
  scene.grid.periodic = {true, true, false};
  scene.sides[2][0] = {true, 0.3};
  const State state = initial_state(scene);
  return make_active_region(state.grid, state.sides, state.particles.positions);
}

TEST(WallFriction, IsBoundedByTheNormalStressAndTheReactionNotByThePressure) {
  const ActiveRegion region = layer_region(3);
  const FrictionOperator friction(region);
  ASSERT_EQ(region.wall_faces.size(), 3u);
  BallBlocks balls = friction.blocks(Field::Ones(region.open_faces + 1));
  Eigen::ArrayXd copies = Eigen::ArrayXd::Zero(balls.values());
  // (S_xx - S_zz) / sqrt 2 = 4 in every copy: S_zz = -4 / sqrt 2, so that the floor carries P + 4 / sqrt 2.
  for (int copy = 0; copy < copies_per_cell * region.cell_count(); ++copy)
    copies[components_per_copy * copy] = 4.0;
  const Field pressure = Field::Constant(region.cell_count() + 1, 10.0);
  const Field mu = Field::Constant(region.cell_count() + 1, 0.5);
  set_friction_radii(region, friction, mu, pressure, pressure, Eigen::ArrayXd::Constant(3, 2.0), copies,
                     balls);
  EXPECT_NEAR(balls.radius[0], std::sqrt(2.0) * 0.5 * 10.0, 1e-12);
  EXPECT_NEAR(balls.radius[balls.count[0]], 0.3 * (10.0 + 4.0 / std::sqrt(2.0) + 2.0), 1e-12);
}

TEST(WarmStart, CarriesTheStressOfEachCellAndWallScaledWithTheTimeStep) {
  const ActiveRegion from = layer_region(3), to = layer_region(3);
  Stress stress = zero_stress(from);
  for (Eigen::Index i = 0; i < from.cell_count(); ++i) stress.pressure[i] = 1.0 + static_cast<double>(i);
  for (Eigen::Index i = 0; i < stress.copies.size(); ++i) stress.copies[i] = 0.1 * static_cast<double>(i + 1);
  const Stress carried = carry_over(from, stress, to, 0.5);
  EXPECT_LT((carried.pressure - 0.5 * stress.pressure).abs().maxCoeff(), 1e-15);
  EXPECT_LT((carried.copies - 0.5 * stress.copies).abs().maxCoeff(), 1e-14);
}

TEST(WarmStart, NewCellsStartWithoutStress) {
  Scene scene = testing::box_scene({6, 1, 4}, {2.0, 1.0, 2.0}, 0.1, 0.5);
  State state = initial_state(scene);
  const ActiveRegion from = make_active_region(state.grid, state.sides, state.particles.positions);
  state.particles.positions.row(0).array() += 0.1;  // one cell on: half of the cells are new
  const ActiveRegion to = make_active_region(state.grid, state.sides, state.particles.positions);
  Stress stress = zero_stress(from);
  stress.pressure.head(from.cell_count()) = 3.0;
  const Stress carried = carry_over(from, stress, to, 1.0);
  EXPECT_EQ((carried.pressure == 3.0).count(), from.cell_count() / 2);
  EXPECT_EQ(carried.pressure.sum(), 3.0 * from.cell_count() / 2);
}

TEST(WarmStart, NeedsNoneOfTheTablesThatARegionGivesAway) {
  std::mt19937_64 random(29);
  const testing::Setting setting{"with_solids", {false, true, false}, {6, 5, 7}, true};
  ActiveRegion from = testing::ragged_sand(setting, random).region();
  const ActiveRegion to = testing::ragged_sand(setting, random).region();
  Stress stress = zero_stress(from);
  stress.copies = testing::random_field(stress.copies.size(), random);
  PaperStress paper = zero_paper_stress(from);
  paper.friction.shear = testing::random_field(paper.friction.shear.size(), random);
  const Stress whole = carry_over(from, stress, to, 0.5);
  const PaperStress whole_paper = carry_over(from, paper, to, 0.5);
  const ActiveRegion taken = take_tables(from);
  EXPECT_EQ(std::ssize(taken.cell_stencils), from.cell_count());
  EXPECT_TRUE((carry_over(from, stress, to, 0.5).copies == whole.copies).all());
  EXPECT_TRUE((carry_over(from, paper, to, 0.5).friction.shear == whole_paper.friction.shear).all());
  EXPECT_GT(whole.copies.abs().maxCoeff(), 0.0);
  EXPECT_GT(whole_paper.friction.shear.abs().maxCoeff(), 0.0);
}

TEST(Pressure, StopsCompressionNeverPullsAndLeavesRoomToBeCompressedInto) {
  const ActiveRegion region = layer_region(2);
  const Eigen::Index cells = region.cell_count();
  const auto solve = [&](double vertical_velocity, double room) {
    Field velocity = Field::Zero(region.open_faces + 1), pressure = Field::Zero(cells + 1);
    for (int f = 0; f < region.open_faces; ++f) {
      if (region.face_axis[static_cast<std::size_t>(f)] == 2) velocity[f] = vertical_velocity;
    }
    Field inverse_mass = Field::Ones(region.open_faces + 1);
    inverse_mass[region.null_face()] = 0.0;
    EXPECT_TRUE(solve_pressure(region, inverse_mass, velocity, Field::Constant(cells + 1, room),
                               {1e-10, 1000}, pressure)
                    .converged);
    return pressure;
  };
  EXPECT_EQ(solve(1.0, 0.0).abs().maxCoeff(), 0.0);         // rising off the floor
  EXPECT_GT(solve(-1.0, 0.0).head(cells).minCoeff(), 0.5);  // falling onto it
  EXPECT_EQ(solve(-1.0, 2.0).abs().maxCoeff(), 0.0);        // with room to fall into
}

}  // namespace
}  // namespace talus
