// The pressure solve: the same minimiser as MPRGP finds, on regions with everything that can be met; its levels, its
// preconditioner, its reports.
#include "continuum/stress/pressure.h"

#include <gtest/gtest.h>

#include "continuum/parallel.h"
#include "tests/continuum/grid/ragged_region.h"

namespace talus {
namespace {

using testing::ragged_region;
using testing::Setting;

/// A pressure problem on a region, with masses that differ tenfold.
struct Instance {
  ActiveRegion region;
  Field inverse_mass, velocity, room;
};

Instance random_instance(ActiveRegion region, std::mt19937_64& random) {
  std::uniform_real_distribution<double> mass(0.1, 1.0), room(-0.5, 1.0);
  const Eigen::Index faces = region.open_faces, cells = region.cell_count();
  Instance instance{std::move(region), Field::Zero(faces + 1), testing::random_field(faces + 1, random),
                    Field::NullaryExpr(cells + 1, [&] { return std::max(0.0, room(random)); })};
  instance.inverse_mass.head(faces) = Field::NullaryExpr(faces, [&] { return 1.0 / mass(random); });
  // Downwards as a whole, so that large parts are pressed together.
  for (int f = 0; f < faces; ++f) {
    if (instance.region.face_axis[static_cast<std::size_t>(f)] == 2) instance.velocity[f] -= 2.0;
  }
  instance.velocity[faces] = 0.0;
  return instance;
}

/// The problem that a solver solves, as it records it.
BoundQp recorded(PressureSolver& solver, const Instance& instance, const Field& start,
                 const BoundQpSettings& settings) {
  BoundQp problem;
  Field pressure = start;
  solver.solve(instance.velocity, instance.room, settings, pressure,
               [&](const Problem& given) { problem = std::get<BoundQp>(given); });
  return problem;
}

/// Solves from `start` and compares with MPRGP. Where nothing couples cells to the free surface the pressure is known up to a
/// constant only; its gradient is compared then.
void expect_minimiser_of_mprgp(const Instance& instance, const Field& start, bool up_to_constant = false) {
  const BoundQpSettings settings{1e-9, 5000};
  PressureSolver solver(instance.region, instance.inverse_mass);
  const BoundQp problem = recorded(solver, instance, start, settings);
  const BoundQpSolution reference = talus::solve(problem);
  Field pressure = start;
  const BoundQpResult result = solver.solve(instance.velocity, instance.room, settings, pressure);
  ASSERT_TRUE(reference.result.converged && result.converged);
  const Eigen::Index n = instance.region.cell_count();
  EXPECT_LE(result.residual, settings.tolerance);
  EXPECT_LE(optimality_residual(problem, pressure.head(n)), 1.1 * settings.tolerance + 1e-12);
  Field difference = pressure.head(n) - reference.x;
  if (up_to_constant) difference -= difference.mean();
  EXPECT_LT(difference.abs().maxCoeff(), 1e-6 * std::max(1.0, reference.x.maxCoeff()));
  EXPECT_LT(result.iterations, reference.result.iterations + 10);
}

ActiveRegion region_of_cells(const Grid& grid, const DomainSides& sides,
                             const std::function<bool(const Eigen::Vector3i&)>& filled) {
  std::vector<Eigen::Vector3d> centres;
  for (int dense = 0; dense < grid.cells.prod(); ++dense) {
    const Eigen::Vector3i at = grid.cell_of_index(dense);
    if (filled(at))
      centres.emplace_back(grid.origin.array() + grid.spacing * (at.cast<double>().array() + 0.5));
  }
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(centres.size()));
  for (std::size_t i = 0; i < centres.size(); ++i) positions.col(static_cast<Eigen::Index>(i)) = centres[i];
  return make_active_region(grid, sides, positions);
}

DomainSides closed_sides() {
  DomainSides sides;
  for (auto& axis : sides) axis = {Side{true, 0.4}, Side{true, 0.0}};
  return sides;
}

Grid grid_of(const Eigen::Vector3i& cells, const std::array<bool, 3>& periodic) {
  return {Eigen::Vector3d::Zero(), 0.5, cells, periodic};
}

/// A column of sand that falls on the floor, `across` cells wide and high, plane strain.
Instance falling_column(int across) {
  DomainSides sides;
  sides[2][0] = {true, 0.4};
  Instance instance{
      region_of_cells(grid_of({2 * across, 1, across + 2}, {false, true, false}), sides,
                      [&](const Eigen::Vector3i& at) { return at[0] < across && at[2] < across; }),
      {},
      {},
      {}};
  instance.inverse_mass = Field::Ones(instance.region.open_faces + 1);
  instance.inverse_mass[instance.region.null_face()] = 0.0;
  instance.velocity = Field::Zero(instance.region.open_faces + 1);
  for (int f = 0; f < instance.region.open_faces; ++f)
    instance.velocity[f] = instance.region.face_axis[static_cast<std::size_t>(f)] == 2 ? -1.0 : 0.0;
  instance.room = Field::Zero(instance.region.cell_count() + 1);
  return instance;
}

class RaggedPressure : public ::testing::TestWithParam<Setting> {};

TEST_P(RaggedPressure, IsTheMinimiserThatMprgpFinds) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const Instance instance = random_instance(ragged_region(GetParam(), random), random);
    const Eigen::Index n = instance.region.cell_count();
    expect_minimiser_of_mprgp(instance, Field::Zero(n + 1));
    expect_minimiser_of_mprgp(instance, testing::random_field(n + 1, random).max(0.0));
  }
}

TEST_P(RaggedPressure, LevelsHoldEveryCellAndColoursPartNeighbours) {
  std::mt19937_64 random(5);
  const ActiveRegion region = ragged_region(GetParam(), random);
  const CellLevels cells = make_cell_levels(region);
  ASSERT_GT(cells.levels.size(), 1u);
  for (std::size_t l = 0; l < cells.levels.size(); ++l) {
    const CellLevel& level = cells.levels[l];
    const auto n = static_cast<std::size_t>(level.count);
    std::vector<int> colour(n, -1);
    for (int c = 0; c < level.colours(); ++c)
      std::fill(colour.begin() + level.colour_begin[static_cast<std::size_t>(c)],
                colour.begin() + level.colour_begin[static_cast<std::size_t>(c) + 1], c);
    EXPECT_EQ(std::count(colour.begin(), colour.end(), -1), 0);
    for (std::size_t i = 0; i < level.neighbours.size(); ++i) {
      const auto neighbour = static_cast<std::size_t>(level.neighbours[i]);
      if (neighbour == n) continue;
      EXPECT_NE(colour[neighbour], colour[i % n]) << "level " << l;
    }
    if (l == 0) continue;
    const CellLevel& finer = cells.levels[l - 1];
    EXPECT_LT(level.count, finer.count);
    EXPECT_EQ(level.children.size(), static_cast<std::size_t>(finer.count));
    for (std::size_t p = 0; p < n; ++p) {
      EXPECT_GT(level.children_begin[p + 1], level.children_begin[p]);
      for (int at = level.children_begin[p]; at < level.children_begin[p + 1]; ++at) {
        const int child = level.children[static_cast<std::size_t>(at)];
        EXPECT_EQ(finer.parent[static_cast<std::size_t>(child)], static_cast<int>(p));
      }
    }
  }
}

TEST_P(RaggedPressure, CycleIsSymmetricAndPositiveAndOnFreeCellsOnly) {
  std::mt19937_64 random(7);
  const Instance instance = random_instance(ragged_region(GetParam(), random), random);
  const CellLevels cells = make_cell_levels(instance.region);
  const CellLaplacian laplacian = make_cell_laplacian(instance.region, cells, instance.inverse_mass);
  Multigrid multigrid(cells, laplacian);
  const Eigen::Index n = instance.region.cell_count();
  std::vector<unsigned char> free(static_cast<std::size_t>(n));
  for (auto& f : free) f = random() % 4 != 0;
  multigrid.set_free(free);
  const auto apply = [&](const Field& r) {
    for (Eigen::Index i = 0; i < n; ++i)
      multigrid.residual()[static_cast<std::size_t>(i)] = static_cast<float>(r[i]);
    multigrid.apply();
    return Field(Eigen::Map<const Eigen::ArrayXf>(multigrid.value().data(), n).cast<double>());
  };
  for (int trial = 0; trial < 5; ++trial) {
    const Field a = testing::random_field(n, random), b = testing::random_field(n, random);
    const Field of_a = apply(a), of_b = apply(b);
    const double size = std::sqrt((a * of_a).sum() * (b * of_b).sum());
    EXPECT_GT((a * of_a).sum(), 0.0);
    EXPECT_NEAR((a * of_b).sum(), (b * of_a).sum(), 1e-5 * size);
    for (Eigen::Index i = 0; i < n; ++i) EXPECT_TRUE(free[static_cast<std::size_t>(i)] || of_a[i] == 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(, RaggedPressure, testing::ragged_settings, testing::name_of_setting);
INSTANTIATE_TEST_SUITE_P(Odd, RaggedPressure,
                         ::testing::Values(Setting{"odd_periodic", {true, true, true}, {5, 3, 7}},
                                           Setting{"odd_and_even", {true, false, true}, {7, 5, 2}},
                                           Setting{"long", {true, true, false}, {31, 1, 9}}),
                         testing::name_of_setting);

TEST(Pressure, OfThinLayersLoneCellsAndRowsIsWhatMprgpFinds) {
  std::mt19937_64 random(3);
  const std::vector<std::function<bool(const Eigen::Vector3i&)>> shapes{
      [](const Eigen::Vector3i& at) { return at[2] == 0; },                // one cell on the floor
      [](const Eigen::Vector3i& at) { return at[2] == 4 || at[2] == 5; },  // in the air
      [](const Eigen::Vector3i& at) {
        return at[0] % 3 + at[1] % 3 + at[2] % 3 == 0;
      },                                                                   // none with a neighbour
      [](const Eigen::Vector3i& at) { return at[1] == 2 && at[2] == 3; },  // a row
      [](const Eigen::Vector3i& at) { return at[0] == 4 && at[1] == 4 && at[2] == 4; }};  // one cell
  for (std::size_t shape = 0; shape < shapes.size(); ++shape) {
    SCOPED_TRACE(shape);
    const Instance instance = random_instance(
        region_of_cells(grid_of({9, 6, 8}, {false, true, false}), closed_sides(), shapes[shape]), random);
    const Eigen::Index n = instance.region.cell_count();
    expect_minimiser_of_mprgp(instance, Field::Zero(n + 1));
    expect_minimiser_of_mprgp(instance, Field::Ones(n + 1));
  }
}

TEST(Pressure, OfAFullClosedBoxIsWhatMprgpFindsUpToAConstant) {
  std::mt19937_64 random(4);
  Instance instance =
      random_instance(region_of_cells(grid_of({6, 5, 7}, {false, false, false}), closed_sides(),
                                      [](const Eigen::Vector3i&) { return true; }),
                      random);
  instance.room.setZero();
  const Eigen::Index n = instance.region.cell_count();
  expect_minimiser_of_mprgp(instance, Field::Zero(n + 1), true);
  expect_minimiser_of_mprgp(instance, Field::Constant(n + 1, 3.0), true);
}

TEST(Pressure, SaysThatAnOverfullClosedBoxHasNone) {
  std::mt19937_64 random(4);
  Instance instance =
      random_instance(region_of_cells(grid_of({6, 5, 7}, {false, false, false}), closed_sides(),
                                      [](const Eigen::Vector3i&) { return true; }),
                      random);
  instance.room.setConstant(-0.1);
  Field pressure = Field::Zero(instance.region.cell_count() + 1);
  const auto result = solve_pressure(instance.region, instance.inverse_mass, instance.velocity, instance.room,
                                     {1e-6, 200}, pressure);
  EXPECT_FALSE(result.converged);
  EXPECT_LE(result.iterations, 200);
  EXPECT_TRUE(pressure.isFinite().all());
}

TEST(Pressure, OfACellWalledInOnEverySideIsZero) {
  std::mt19937_64 random(4);
  const Instance instance =
      random_instance(region_of_cells(grid_of({1, 1, 1}, {false, false, false}), closed_sides(),
                                      [](const Eigen::Vector3i&) { return true; }),
                      random);
  Field pressure = Field::Constant(2, 5.0);
  EXPECT_TRUE(solve_pressure(instance.region, instance.inverse_mass, instance.velocity,
                             Field::Constant(2, -1.0), {1e-6, 10}, pressure)
                  .converged);
  EXPECT_EQ(pressure[0], 0.0);
}

TEST(Pressure, StopsAtItsCapAndSaysSo) {
  const Instance instance = falling_column(32);
  for (const int cap : {0, 1, 2}) {
    Field pressure = Field::Zero(instance.region.cell_count() + 1);
    const auto result = solve_pressure(instance.region, instance.inverse_mass, instance.velocity,
                                       instance.room, {1e-12, cap}, pressure);
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.iterations, cap);
    EXPECT_GT(result.residual, 1e-12);
  }
}

TEST(Pressure, ThatPullsHoldsTogetherWhatFliesApart) {
  // Rising from the floor and flying apart: sand lets it, a liquid does not.
  Instance instance = falling_column(12);
  instance.velocity = -instance.velocity;
  const BoundQpSettings settings{1e-9, 5000};
  PressureSolver solver(instance.region, instance.inverse_mass);
  const Eigen::Index n = instance.region.cell_count();
  Field sand = Field::Zero(n + 1), liquid = sand;
  EXPECT_TRUE(solver.solve(instance.velocity, instance.room, settings, sand).converged);
  EXPECT_EQ(sand.abs().maxCoeff(), 0.0);
  EXPECT_TRUE(solver.solve_pulling(instance.velocity, Field(), settings, liquid).converged);
  EXPECT_LT(liquid.minCoeff(), -1.0);
  Field impulse = Field::Zero(instance.velocity.size()), divergence(n + 1);
  add_gradient(instance.region, liquid, -1.0, impulse);
  gradient_transpose(instance.region, instance.velocity + instance.inverse_mass * impulse, divergence);
  EXPECT_LE(divergence.head(n).abs().maxCoeff(), 1.1e-9);
  // Where it pushes, it is what sand's is with no room: the problem turned upside down.
  Field pushed = Field::Zero(n + 1);
  solver.solve(-instance.velocity, instance.room, settings, pushed);
  EXPECT_LT((pushed + liquid).abs().maxCoeff(), 1e-6 * pushed.maxCoeff());
}

TEST(Pressure, TakesNoIterationFromTheSolution) {
  const Instance instance = falling_column(16);
  PressureSolver solver(instance.region, instance.inverse_mass);
  Field pressure = Field::Zero(instance.region.cell_count() + 1);
  ASSERT_TRUE(solver.solve(instance.velocity, instance.room, {1e-10, 100}, pressure).converged);
  const Field solution = pressure;
  EXPECT_EQ(solver.solve(instance.velocity, instance.room, {1e-8, 100}, pressure).iterations, 0);
  EXPECT_EQ((pressure - solution).abs().maxCoeff(), 0.0);
}

TEST(Pressure, StaysZeroWhereZeroIsASolution) {
  Instance instance = falling_column(16);
  instance.velocity *= 1e-9;
  Field pressure = Field::Zero(instance.region.cell_count() + 1);
  const auto result = solve_pressure(instance.region, instance.inverse_mass, instance.velocity, instance.room,
                                     {1e-8, 100}, pressure);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(pressure.abs().maxCoeff(), 0.0);
}

TEST(Pressure, IsTheSameBitsFromAUsedSolver) {
  std::mt19937_64 random(8);
  const Instance instance =
      random_instance(ragged_region({"", {false, true, false}, {14, 13, 12}}, random), random);
  const Instance other{instance.region, instance.inverse_mass, -instance.velocity, instance.room};
  const BoundQpSettings settings{1e-6, 100};
  const Field start = Field::Zero(instance.region.cell_count() + 1);
  Field fresh = start, used = start, ignored = start;
  PressureSolver(instance.region, instance.inverse_mass)
      .solve(instance.velocity, instance.room, settings, fresh);
  PressureSolver solver(instance.region, instance.inverse_mass);
  solver.solve(other.velocity, other.room, settings, ignored);
  solver.solve(instance.velocity, instance.room, settings, used);
  EXPECT_TRUE((fresh == used).all());
}

TEST(Pressure, IsTheSameBitsWithTwoThreads) {
  std::mt19937_64 random(6);
  const Instance instance =
      random_instance(ragged_region({"", {false, true, false}, {29, 25, 23}}, random), random);
  ASSERT_GT(instance.region.cell_count(), 4 * cells_per_block);
  const auto solve = [&](int threads) {
    set_thread_count(threads);
    Field pressure = Field::Zero(instance.region.cell_count() + 1);
    EXPECT_TRUE(solve_pressure(instance.region, instance.inverse_mass, instance.velocity, instance.room,
                               {1e-8, 100}, pressure)
                    .converged);
    set_thread_count(1);
    return pressure;
  };
  EXPECT_TRUE((solve(1) == solve(2)).all());
}

TEST(Pressure, IterationsHardlyGrowWithTheMesh) {
  const BoundQpSettings of_a_run{0.01, 100};
  for (const int across : {32, 64, 128}) {
    SCOPED_TRACE(across);
    Instance instance = falling_column(across);
    PressureSolver solver(instance.region, instance.inverse_mass);
    Field pressure = Field::Zero(instance.region.cell_count() + 1);
    const auto cold = solver.solve(instance.velocity, instance.room, of_a_run, pressure);
    EXPECT_TRUE(cold.converged);
    EXPECT_LE(cold.iterations, 12);
    pressure *= 1.3;  // as after a change of the time step
    const auto warm = solver.solve(instance.velocity, instance.room, of_a_run, pressure);
    EXPECT_TRUE(warm.converged);
    EXPECT_LE(warm.iterations, 12);
  }
}

}  // namespace
}  // namespace talus
