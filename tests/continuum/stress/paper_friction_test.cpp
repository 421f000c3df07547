// The source's friction problem: every component step is solved to its optimality conditions, inside the box.
#include "continuum/stress/paper_friction.h"

#include <gtest/gtest.h>

#include <algorithm>

#include <random>

#include "tests/continuum/grid/ragged_region.h"

namespace talus {
namespace {

constexpr BoundQpSettings tight{1e-10, 10000};

struct Setting {
  const char* name;
  std::array<bool, 3> periodic;
  Eigen::Vector3i cells;
  int up;
};

void PrintTo(const Setting& setting, std::ostream* out) { *out << setting.name; }

/// A ragged cloud of particles with holes, against frictional walls here and there; random flux, mass and pressure.
class PaperFrictionTest : public ::testing::TestWithParam<Setting> {
 protected:
  PaperFrictionTest() : region_(ragged_region()), friction_(region_, inverse_mass_, GetParam().up) {
    box_ = friction_box(region_, Field::Constant(region_.cell_count() + 1, 0.5), pressure_);
  }

  ActiveRegion ragged_region() {
    const Grid grid{Eigen::Vector3d::Zero(), 0.5, GetParam().cells, GetParam().periodic};
    DomainSides sides;
    for (auto& axis : sides) axis = {Side{true, 0.4}, Side{true, 0.0}};
    Eigen::Matrix3Xd positions(3, 2 * grid.cells.prod());
    for (double& value : positions.reshaped()) value = std::uniform_real_distribution<double>()(random_);
    positions.array().colwise() *= grid.upper().array();
    ActiveRegion region = make_active_region(grid, sides, positions);
    inverse_mass_ = 0.5 + random_field(region.open_faces + 1).abs();
    inverse_mass_[region.null_face()] = 0.0;
    frictionless_ = random_field(region.open_faces + 1);
    frictionless_[region.null_face()] = 0.0;
    pressure_ = random_field(region.cell_count() + 1).max(0.0);
    pressure_[region.null_cell()] = 0.0;
    return region;
  }
  Field random_field(Eigen::Index n) {
    std::normal_distribution<double> normal;
    return Field::NullaryExpr(n, [&] { return normal(random_); });
  }

  int up() const { return GetParam().up; }
  int next() const { return next_axis(up()); }
  int last() const { return last_axis(up()); }
  Eigen::Index cells() const { return region_.cell_count(); }
  Field diagonal(const StressField& field, int axis) const {
    return field.diagonal.row(axis).head(cells()).transpose();
  }
  std::vector<int> edges_along(int axis) const {
    std::vector<int> edges;
    for (int e = 0; e < region_.edge_count(); ++e)
      if (region_.edge_axis[static_cast<std::size_t>(e)] == axis) edges.push_back(e);
    return edges;
  }

  /// Flux kinetic energy 1/2 sum M u^2.
  double energy(const StressField& stress) const {
    const Field u = friction_.flux(frictionless_, stress);
    return 0.5 * (inverse_mass_ > 0.0).select(u.square() / inverse_mass_.max(1e-300), 0.0).sum();
  }
  StressField gradient(const StressField& stress) const {
    StressField strain = make_stress_field(region_);
    stress_divergence_transpose(region_, friction_.flux(frictionless_, stress), strain);
    return strain;
  }
  /// A stress inside the box, trace-free.
  StressField feasible_stress() {
    StressField stress = make_stress_field(region_);
    const auto within = [&](const Field& low, const Field& high) {
      return Field(low + (0.5 + 0.5 * random_field(low.size()).sin()) * (high - low));
    };
    const Field radius = box_.cell.head(cells());
    const Field vertical = within(-radius, radius);
    const Field x = within((-radius).max(-radius - vertical), radius.min(radius - vertical));
    stress.diagonal.row(up()).head(cells()) = vertical.transpose();
    stress.diagonal.row(last()).head(cells()) = x.transpose();
    stress.diagonal.row(next()).head(cells()) = -(vertical + x).transpose();
    stress.shear = within(-box_.edge, box_.edge);
    return stress;
  }

  /// Optimality of a box-constrained minimum: no gradient inside, none that points into the box at a bound.
  static void expect_optimal(const Field& x, const Field& low, const Field& high, const Field& gradient) {
    int inside = 0, bound = 0;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const double margin = 1e-13 * (high[i] - low[i]);
      EXPECT_GE(x[i], low[i] - margin);
      EXPECT_LE(x[i], high[i] + margin);
      if (low[i] >= high[i]) continue;
      EXPECT_LT(x[i] > low[i] + margin ? gradient[i] : 0.0, 1e-9);
      EXPECT_GT(x[i] < high[i] - margin ? gradient[i] : 0.0, -1e-9);
      (x[i] > low[i] + margin && x[i] < high[i] - margin ? inside : bound) += 1;
    }
    EXPECT_GT(bound, 0);  // the case would prove little otherwise
    EXPECT_GT(inside, 0);
  }

  std::mt19937_64 random_{11};
  Field inverse_mass_, frictionless_, pressure_;
  ActiveRegion region_;
  PaperFriction friction_;
  FrictionBox box_;
};

TEST_P(PaperFrictionTest, EnergyGradientIsTheTransposedDivergenceOfTheFlux) {
  const StressField stress = feasible_stress(), step = feasible_stress();
  const auto moved = [&](double amount) {
    return StressField{stress.diagonal + amount * step.diagonal, stress.shear + amount * step.shear, {}};
  };
  const StressField slope = gradient(stress);
  const double conjugate = (slope.diagonal * step.diagonal).sum() + (slope.shear * step.shear).sum();
  EXPECT_NEAR((energy(moved(0.5)) - energy(moved(-0.5))), conjugate, 1e-10 * energy(stress));
}

TEST_P(PaperFrictionTest, VerticalStressIsOptimalInItsBox) {
  StressField stress = feasible_stress();
  ASSERT_TRUE(friction_.solve_up(frictionless_, box_, tight, stress).converged);
  const Field radius = box_.cell.head(cells());
  expect_optimal(diagonal(stress, up()), -radius, radius, diagonal(gradient(stress), up()));
}

TEST_P(PaperFrictionTest, ColumnsOneByOneGiveTheSameAsAllAtOnce) {
  const StressField start = feasible_stress();
  StressField by_columns = start, at_once = start;
  ASSERT_TRUE(friction_.solve_columns(frictionless_, box_, tight, by_columns).converged);
  ASSERT_TRUE(friction_.solve_up(frictionless_, box_, tight, at_once).converged);
  EXPECT_LT((by_columns.diagonal - at_once.diagonal).abs().maxCoeff(), 1e-8);
  EXPECT_EQ((by_columns.shear - at_once.shear).abs().maxCoeff(), 0.0);
  EXPECT_GT((by_columns.diagonal - start.diagonal).abs().maxCoeff(), 1e-3);
}

TEST_P(PaperFrictionTest, HorizontalPairIsOptimalInBothBoxesAndLeavesNoTrace) {
  StressField stress = feasible_stress();
  stress.diagonal.row(up()).head(cells()) =
      0.7 * box_.cell.head(cells()).transpose();  // a trace, as step 1 leaves
  ASSERT_TRUE(friction_.solve_pair(frictionless_, box_, tight, stress).converged);
  EXPECT_LT(stress.diagonal.colwise().sum().abs().maxCoeff(), 1e-14);
  const Field radius = box_.cell.head(cells()), vertical = diagonal(stress, up());
  const StressField slope = gradient(stress);
  expect_optimal(diagonal(stress, last()), (-radius).max(-radius - vertical), radius.min(radius - vertical),
                 diagonal(slope, last()) - diagonal(slope, next()));
  EXPECT_LE((diagonal(stress, next()).abs() - radius).maxCoeff(), 1e-14);
}

TEST_P(PaperFrictionTest, ShearsAreOptimalInTheirBoxes) {
  for (int axis = 0; axis < 3; ++axis) {
    StressField stress = feasible_stress();
    ASSERT_TRUE(friction_.solve_shear(axis, frictionless_, box_, tight, stress).converged);
    const std::vector<int> edges = edges_along(axis);
    if (edges.empty()) continue;
    expect_optimal(stress.shear(edges), -box_.edge(edges), box_.edge(edges), gradient(stress).shear(edges));
  }
}

TEST_P(PaperFrictionTest, EveryStepLowersTheFluxEnergyOfWhatItStartsFrom) {
  StressField stress = feasible_stress();
  double before = energy(stress);
  const auto expect_lower = [&](const char* step) {
    EXPECT_LT(energy(stress), before * (1.0 + 1e-12)) << step;
    before = energy(stress);
  };
  friction_.solve_up(frictionless_, box_, tight, stress);
  expect_lower("vertical");
  // The trace that is left has to go first; that, and only that, can cost energy.
  const Field radius = box_.cell.head(cells()), vertical = diagonal(stress, up());
  const Field x =
      diagonal(stress, last()).max((-radius).max(-radius - vertical)).min(radius.min(radius - vertical));
  stress.diagonal.row(last()).head(cells()) = x.transpose();
  stress.diagonal.row(next()).head(cells()) = -(vertical + x).transpose();
  before = energy(stress);
  friction_.solve_pair(frictionless_, box_, tight, stress);
  expect_lower("pair");
  for (const int axis : {next(), last(), up()}) {
    friction_.solve_shear(axis, frictionless_, box_, tight, stress);
    expect_lower("shear");
  }
}

TEST_P(PaperFrictionTest, AWholePassStaysInTheBoxWithoutTraceWhateverItStartsFrom) {
  StressField stress = feasible_stress();
  stress.diagonal *= 3.0;
  stress.shear *= 3.0;
  const auto result = friction_.solve(frictionless_, box_, tight, stress);
  EXPECT_EQ(result.unconverged, 0);
  EXPECT_LE(result.residual, tight.tolerance);
  EXPECT_LT(stress.diagonal.colwise().sum().abs().maxCoeff(), 1e-14);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_LE((diagonal(stress, axis).abs() - box_.cell.head(cells())).maxCoeff(), 1e-14);
  EXPECT_LE((stress.shear.abs() - box_.edge).maxCoeff(), 1e-14);
}

TEST_P(PaperFrictionTest, ACapThatIsHitIsCounted) {
  StressField stress = make_stress_field(region_);
  const auto result = friction_.solve(frictionless_, box_, {1e-12, 1}, stress);
  EXPECT_GT(result.unconverged, 0);
  EXPECT_GT(result.residual, 1e-12);
}

TEST(PaperFrictionBesideASlope, ColumnsThatTheSlopeCouplesAreSolvedTogether) {
  std::mt19937_64 random(3);
  // A plane of 30 degrees through a box that is full of sand above it.
  const Grid grid{Eigen::Vector3d::Zero(), 1.0, {10, 1, 10}, {false, true, false}};
  const Eigen::Vector3d normal(0.5, 0.0, std::sqrt(0.75));
  const Openings openings = make_openings(grid, [&](const Eigen::Vector3d& x) {
    return WallDistance{(x - Eigen::Vector3d(0.3, 0.0, 5.6)).dot(normal), 0.3};
  });
  Eigen::Matrix3Xd positions(3, 100);
  int n = 0;
  for (int cell = 0; cell < 100; ++cell) {
    if (openings.cell_share(cell) > 0.0)
      positions.col(n++) = grid.cell_of_index(cell).cast<double>().array() + 0.5;
  }
  const ActiveRegion region = make_active_region(grid, {}, positions.leftCols(n), openings);
  const int up = 2;
  ASSERT_TRUE(std::any_of(region.closures.begin(), region.closures.end(),
                          [&](const Closure& closure) { return closure.axis == up; }));
  const Field velocity = testing::random_field(region.open_faces + 1, random);
  Field inverse_mass = Field::Ones(region.open_faces + 1), frictionless = velocity;
  inverse_mass[region.null_face()] = frictionless[region.null_face()] = 0.0;
  const PaperFriction friction(region, inverse_mass, up);
  const FrictionBox box = friction_box(region, Field::Constant(region.cell_count() + 1, 0.5),
                                       Field::Ones(region.cell_count() + 1));
  StressField by_columns = make_stress_field(region), at_once = by_columns;
  ASSERT_TRUE(friction.solve_columns(frictionless, box, {1e-10, 10000}, by_columns).converged);
  ASSERT_TRUE(friction.solve_up(frictionless, box, {1e-10, 10000}, at_once).converged);
  const auto energy = [&](const StressField& stress) {
    return friction.flux(frictionless, stress).square().sum();
  };
  EXPECT_LT(energy(at_once), energy(make_stress_field(region)));
  EXPECT_NEAR(energy(by_columns), energy(at_once), 1e-8 * energy(at_once));
}

INSTANTIATE_TEST_SUITE_P(Settings, PaperFrictionTest,
                         ::testing::Values(Setting{"up_y", {false, false, false}, {5, 6, 4}, 1},
                                           Setting{"up_z", {false, false, false}, {5, 4, 6}, 2},
                                           Setting{"up_x", {false, true, false}, {6, 4, 5}, 0},
                                           Setting{"periodic", {true, true, true}, {4, 5, 4}, 1},
                                           Setting{"plane_strain", {false, true, false}, {9, 1, 7}, 2}),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(PaperFrictionBox, IsAlphaTimesThePressureAroundAnEdgeAndMuTimesThePressureBesideAWall) {
  // Two cells side by side on a floor, one cell on top of the left one; mu = 0.6, mu_w = 0.3.
  const Grid grid{Eigen::Vector3d::Zero(), 1.0, {4, 1, 4}, {false, true, false}};
  DomainSides sides;
  sides[2][0] = {true, 0.3};
  const Eigen::Matrix3Xd positions{{1.5, 2.5, 1.5}, {0.5, 0.5, 0.5}, {0.5, 0.5, 1.5}};
  const ActiveRegion region = make_active_region(grid, sides, positions);
  Field pressure(4);
  pressure << 8.0, 4.0, 2.0, 0.0;
  const FrictionBox box = friction_box(region, Field::Constant(4, 0.6), pressure);
  const double alpha = std::sqrt(2.0 / 3.0) * 0.6;
  EXPECT_NEAR(box.cell[0], alpha * 8.0, 1e-14);
  const auto edge = [&](int x, int z) {
    return box.edge[region.edge_of_dense[1][static_cast<std::size_t>(grid.edge_index(1, {x, 0, z}))]];
  };
  EXPECT_NEAR(edge(2, 1), alpha * (8.0 + 4.0 + 2.0 + 0.0) / 4.0, 1e-14);  // the empty cell counts as p = 0
  EXPECT_NEAR(edge(2, 0), 0.3 * (8.0 + 4.0) / 2.0, 1e-14);
  EXPECT_NEAR(edge(1, 0), 0.3 * (8.0 + 0.0) / 2.0, 1e-14);
}

TEST(PaperFrictionBox, UpIsTheAxisGravityPointsAlongMost) {
  EXPECT_EQ(up_axis({0.0, 0.0, -9.81}), 2);
  EXPECT_EQ(up_axis({3.0, -9.0, 2.0}), 1);
  EXPECT_EQ(up_axis({9.0, -3.0, 2.0}), 0);
  EXPECT_EQ(up_axis({0.0, 0.0, 0.0}), 2);
}

}  // namespace
}  // namespace talus
