// |shear rate| of flows whose gradient is known.
#include "continuum/stress/shear_rate.h"

#include <gtest/gtest.h>

#include "tests/continuum/scenes.h"

namespace talus {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double h = 0.1;  // m

class ShearRate : public ::testing::Test {
 protected:
  State state_ = initial_state(testing::box_scene({6, 6, 6}, {6.0, 6.0, 6.0}, h, 0.5));
  ActiveRegion region_ = make_active_region(state_.grid, state_.sides, state_.particles.positions);

  /// Of v = constant + matrix x, cell by cell.
  Field of(const Matrix3d& matrix, const Vector3d& constant = Vector3d::Zero()) const {
    Field faces = Field::Zero(region_.face_count());
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3i n = state_.grid.extent(Grid::nodal_of_face(axis));
      for (int dense = 0; dense < n.prod(); ++dense) {
        const Vector3i at(dense % n[0], dense / n[0] % n[1], dense / (n[0] * n[1]));
        const Vector3d place =
            h * (at.cast<double>().array() + 0.5).matrix() - 0.5 * h * Vector3d::Unit(axis);
        faces[region_.face_of_dense[static_cast<std::size_t>(axis)][static_cast<std::size_t>(dense)]] =
            constant[axis] + matrix.row(axis).dot(place);
      }
    }
    return shear_rate(region_, faces);
  }
  bool inner(int cell) const {
    const Vector3i at = state_.grid.cell_of_index(region_.dense_of_cell[static_cast<std::size_t>(cell)]);
    return at.minCoeff() > 0 && at.maxCoeff() < 5;
  }
  /// In cells that have all their edges; `everywhere` in those at the surface too, whose shear is the mean over fewer.
  void expect(double rate, const Matrix3d& matrix, bool everywhere = false) const {
    const Field rates = of(matrix, {1.0, -2.0, 0.5});
    int cells = 0;
    for (int cell = 0; cell < region_.cell_count(); ++cell) {
      if (!inner(cell) && !everywhere) continue;
      EXPECT_NEAR(rates[cell], rate, 1e-11) << cell;
      ++cells;
    }
    EXPECT_EQ(cells, everywhere ? 216 : 64);
    EXPECT_EQ(rates[region_.null_cell()], 0.0);
  }
};

Matrix3d gradient_of(std::initializer_list<double> values) {
  Matrix3d m;
  auto v = values.begin();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m(i, j) = *v++;
  return m;
}

TEST_F(ShearRate, SimpleShearGivesItsGradient) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (i == j) continue;
      Matrix3d m = Matrix3d::Zero();
      m(i, j) = -7.0;
      expect(7.0, m, true);
    }
  }
}

TEST_F(ShearRate, RigidMotionHasNone) {
  expect(0.0, Matrix3d::Zero(), true);
  expect(0.0, gradient_of({0, -3, 2, 3, 0, -1, -2, 1, 0}), true);
}

TEST_F(ShearRate, SwellingHasNone) { expect(0.0, 4.0 * Matrix3d::Identity(), true); }

TEST_F(ShearRate, StretchingAlongOneAxis) {
  // e' = a (2, -1, -1) / 3: sqrt(2 e':e') = a sqrt(4/3).
  for (int axis = 0; axis < 3; ++axis) {
    Matrix3d m = Matrix3d::Zero();
    m(axis, axis) = 6.0;
    expect(6.0 * std::sqrt(4.0 / 3.0), m, true);
  }
  // Plane strain, pure shear: as simple shear of twice the rate.
  expect(10.0, Vector3d(5.0, 0.0, -5.0).asDiagonal().toDenseMatrix(), true);
}

TEST_F(ShearRate, AnyGradientGivesTheNormOfItsDeviator) {
  const Matrix3d m = gradient_of({1, 2, -3, 0.5, -1.5, 0.7, 4, -2, 0.5});
  Matrix3d e = 0.5 * (m + m.transpose());
  e -= e.trace() / 3.0 * Matrix3d::Identity();
  expect(std::sqrt(2.0) * e.norm(), m);
}

}  // namespace
}  // namespace talus
