// Assembled matrices against the matrix-free operators they stand for.
#include "continuum/stress/assemble.h"

#include <gtest/gtest.h>

#include <chrono>

#include "continuum/stress/pressure.h"
#include "tests/continuum/grid/ragged_region.h"

namespace talus {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

class Assembly : public ::testing::TestWithParam<testing::Setting> {
 protected:
  Field random_field(Eigen::Index n) { return testing::random_field(n, random_); }
  /// With the null entry behind it.
  static Field padded(const Field& values) {
    Field field = Field::Zero(values.size() + 1);
    field.head(values.size()) = values;
    return field;
  }
  Field no_impulse() const { return Field::Zero(region_.open_faces + 1); }
  static void expect_same(const Field& expected_padded, const SparseMatrix& matrix, const Field& x) {
    const Field expected = expected_padded.head(expected_padded.size() - 1);
    ASSERT_EQ(matrix.cols(), x.size());
    ASSERT_EQ(matrix.rows(), expected.size());
    EXPECT_GT(expected.abs().maxCoeff(), 0.0);
    EXPECT_LT(((matrix * x.matrix()).array() - expected).abs().maxCoeff(), 1e-13 * expected.abs().maxCoeff());
  }

  std::mt19937_64 random_{11};
  ActiveRegion region_ = testing::ragged_region(GetParam(), random_);
};

TEST_P(Assembly, Gradient) {
  const Field p = random_field(region_.cell_count());
  Field faces = no_impulse();
  add_gradient(region_, padded(p), 1.0, faces);
  expect_same(faces, sparse_gradient(region_), p);
}

TEST_P(Assembly, GradientTransposed) {
  const Field v = random_field(region_.open_faces);
  Field cells = Field::Zero(region_.cell_count() + 1);
  gradient_transpose(region_, padded(v), cells);
  expect_same(cells, sparse_gradient(region_).transpose(), v);
}

TEST_P(Assembly, DivergenceOfEachDiagonalComponent) {
  for (int axis = 0; axis < 3; ++axis) {
    StressField stress = make_stress_field(region_);
    const Field component = random_field(region_.cell_count());
    stress.diagonal.row(axis) = padded(component).transpose();
    Field faces = no_impulse();
    add_stress_divergence(region_, stress, faces);
    const SparseMatrix matrix = sparse_diagonal_divergence(region_, axis);
    if (region_.grid.periodic[static_cast<std::size_t>(axis)] && region_.grid.cells[axis] == 1)
      EXPECT_EQ(matrix.nonZeros(), 0);  // nothing can differ across one cell
    else
      expect_same(faces, matrix, component);
  }
}

TEST_P(Assembly, DivergenceOfTheShearStress) {
  StressField stress = make_stress_field(region_);
  const Field shear = random_field(region_.edge_count());
  stress.shear = padded(shear);
  Field faces = no_impulse();
  add_stress_divergence(region_, stress, faces);
  expect_same(faces, sparse_shear_divergence(region_), shear);
}

TEST_P(Assembly, FrictionOperatorAndItsTranspose) {
  const FrictionOperator friction(region_);
  const SparseMatrix k = sparse_friction(region_, friction);
  const Field copies = random_field(k.cols()), v = random_field(region_.open_faces);
  Field faces = no_impulse();
  friction.apply(copies, faces);
  expect_same(faces, k, copies);
  Field strain(k.cols());
  friction.apply_transpose(padded(v), strain);
  friction.clear_idle(strain);  // idle values have empty columns
  expect_same(padded(strain), k.transpose(), v);
}

TEST_P(Assembly, NormalMatrixIsThePressureProblem) {
  const Field inverse_mass = random_field(region_.open_faces).abs() + 0.1;
  const SparseMatrix matrix = normal_matrix(sparse_gradient(region_), inverse_mass);
  EXPECT_EQ(SparseMatrix(matrix - SparseMatrix(matrix.transpose())).norm(), 0.0);
  const Field p = random_field(region_.cell_count());
  Field faces = no_impulse(), cells = Field::Zero(region_.cell_count() + 1);
  add_gradient(region_, padded(p), 1.0, faces);
  gradient_transpose(region_, faces * padded(inverse_mass), cells);
  expect_same(cells, matrix, p);
}

INSTANTIATE_TEST_SUITE_P(Settings, Assembly, testing::ragged_settings, testing::name_of_setting);

TEST(Assemble, RefusesAnOperatorThatActsOutsideItsPattern) {
  const auto shift = [](const Eigen::ArrayXd& x, Eigen::ArrayXd& y) {
    for (Eigen::Index i = 0; i < x.size(); ++i) y[i] = x[(i + 1) % x.size()];
  };
  EXPECT_EQ(assemble(shift, {3, {{1}, {2}, {0}}}).nonZeros(), 3);
  EXPECT_THROW(assemble(shift, {3, {{1}, {2}, {1}}}), std::logic_error);
}

TEST(Assemble, TakesSecondsForTwentyThousandCells) {
  std::mt19937_64 random(3);
  const ActiveRegion region = testing::ragged_region({"large", {false, false, false}, {32, 32, 32}}, random);
  ASSERT_GT(region.cell_count(), 20000);
  const auto start = std::chrono::steady_clock::now();
  const SparseMatrix k = sparse_friction(region, FrictionOperator(region));
  const SparseMatrix a = normal_matrix(sparse_gradient(region), Field::Ones(region.open_faces));
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  RecordProperty("seconds", std::to_string(taken.count()));
  EXPECT_GT(k.nonZeros(), 1000000);
  EXPECT_LT(taken.count(), 10.0);
}

}  // namespace
}  // namespace talus
