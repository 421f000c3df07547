// Mass, centre and inertia against sums over many small cubes, against formulas, and against each other.
#include "continuum/solids/mass_properties.h"

#include <gmock/gmock.h>

#include <numbers>

#include "tests/continuum/solids/mesh_files.h"
#include "tests/continuum/solids/specimens.h"
#include "tests/test_folder.h"

namespace talus {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double pi = std::numbers::pi;
const Vector3d base(0.3, -0.2, 0.1);
const Vector3d oblique = Vector3d(2.0, -1.0, 2.0) / 3.0;

/// The same by summing over cubes whose centre is inside.
MassProperties summed(const testing::Specimen& specimen, int cubes_along) {
  const Eigen::AlignedBox3d box = bounds(specimen.shape);
  const Vector3d size = box.sizes() / cubes_along;
  double count = 0.0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (int k = 0; k < cubes_along; ++k) {
    for (int j = 0; j < cubes_along; ++j) {
      for (int i = 0; i < cubes_along; ++i) {
        const Vector3d at = box.min() + size.cwiseProduct(Vector3d(i + 0.5, j + 0.5, k + 0.5));
        if (!specimen.inside(at)) continue;
        ++count;
        first += at;
        second += at * at.transpose();
      }
    }
  }
  const Vector3d centre = first / count;
  second = size.prod() * (second - count * centre * centre.transpose());
  return {count * size.prod(), centre, second.trace() * Matrix3d::Identity() - second};
}

void expect_same(const MassProperties& a, const MassProperties& b, double tolerance) {
  const double size = std::cbrt(b.volume);
  EXPECT_NEAR(a.volume, b.volume, tolerance * b.volume);
  EXPECT_LT((a.centre - b.centre).norm(), tolerance * size);
  EXPECT_LT((a.inertia - b.inertia).norm(), tolerance * b.inertia.norm());
}

class MassOfEveryShape : public ::testing::TestWithParam<testing::SpecimenMaker> {};

TEST_P(MassOfEveryShape, IsTheSumOverItsInside) {
  const testing::Specimen specimen = GetParam().make();
  if (body_fault(specimen.shape)) {
    EXPECT_THROW(mass_properties(specimen.shape), std::invalid_argument);
    return;
  }
  expect_same(mass_properties(specimen.shape), summed(specimen, GetParam().name == "Mesh" ? 50 : 100), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Solids, MassOfEveryShape, ::testing::ValuesIn(testing::specimens()),
                         [](const auto& tested) { return tested.param.name; });

TEST(MassProperties, OfACylinderAConeAndACapsuleByTheirFormulas) {
  const double r = 0.3, l = 0.8;
  const MassProperties rod = mass_properties({cylinder(base, oblique, r, l)});
  EXPECT_NEAR(rod.volume, pi * r * r * l, 1e-15);
  EXPECT_LT((rod.centre - (base + 0.5 * l * oblique)).norm(), 1e-15);
  EXPECT_NEAR(oblique.dot(rod.inertia * oblique), rod.volume * r * r / 2.0, 1e-15);
  const Vector3d across = oblique.unitOrthogonal();
  EXPECT_NEAR(across.dot(rod.inertia * across), rod.volume * (3.0 * r * r + l * l) / 12.0, 1e-15);

  const MassProperties point = mass_properties({cone(base, oblique, r, 0.0, l)});
  EXPECT_NEAR(point.volume, pi * r * r * l / 3.0, 1e-15);
  EXPECT_LT((point.centre - (base + 0.25 * l * oblique)).norm(), 1e-15);
  EXPECT_NEAR(oblique.dot(point.inertia * oblique), 0.3 * point.volume * r * r, 1e-15);
  EXPECT_NEAR(across.dot(point.inertia * across), point.volume * (0.15 * r * r + 0.0375 * l * l), 1e-15);

  const MassProperties ball = mass_properties({Sphere{base, r}}),
                       no_length{mass_properties({Capsule{base, base, r}})};
  expect_same(no_length, ball, 1e-14);
}

TEST(MassProperties, OfAProfileDoNotDependOnItsSense) {
  const std::vector<Eigen::Vector2d> corners{{0.3, 0},   {0.8, 0},   {0.8, 0.2},
                                             {0.5, 0.2}, {0.5, 0.6}, {0.3, 0.6}};
  const std::vector<Eigen::Vector2d> back(corners.rbegin(), corners.rend());
  expect_same(mass_properties({Revolved{base, oblique, back}}),
              mass_properties({Revolved{base, oblique, corners}}), 1e-14);
}

TEST(MassProperties, OfAMeshAreThoseOfTheBoxItBounds) {
  const testing::TestFolder folder;
  const Vector3d lower(1.0, -0.5, 0.25), upper(1.5, 0.5, 2.25);  // exact in single precision
  testing::write_text_stl(folder.path() / "box.stl", testing::box_mesh(lower, upper));
  const MassProperties exact = mass_properties({Box{0.5 * (lower + upper), 0.5 * (upper - lower)}});
  expect_same(mass_properties({read_mesh(folder.path() / "box.stl")}), exact, 1e-13);
}

TEST(MassProperties, SayWhatCannotBeABody) {
  EXPECT_THAT(body_fault({Plane{base, oblique}}).value(), ::testing::HasSubstr("must be bounded"));
  EXPECT_THAT(body_fault({Sphere{base, 1.0}, true}).value(), ::testing::HasSubstr("must not be hollow"));
  EXPECT_FALSE(body_fault({Sphere{base, 1.0}}).has_value());
}

TEST(Inradius, IsThatOfTheLargestBallInside) {
  EXPECT_DOUBLE_EQ(inradius({Box{base, {0.5, 0.1, 0.3}}}), 0.1);
  EXPECT_DOUBLE_EQ(inradius({Capsule{base, base + oblique, 0.2}}), 0.2);
  EXPECT_NEAR(inradius({cylinder(base, oblique, 0.3, 2.0)}), 0.3, 1e-15);
  EXPECT_NEAR(inradius({cylinder(base, oblique, 0.3, 0.02)}), 0.01, 1e-15);
  // A ball in a cone touches its base and its side: r (1 + 1/sin of half the angle at the tip) = height.
  const double tip = std::atan2(0.5, 1.2);
  const double ball = 1.2 / (1.0 + 1.0 / std::sin(tip));
  EXPECT_NEAR(inradius({cone(base, oblique, 0.5, 0.0, 1.2)}), ball, 0.01 * ball);
  EXPECT_LE(inradius({cone(base, oblique, 0.5, 0.0, 1.2)}), ball * (1.0 + 1e-12));
  const Revolved ring{base, oblique, {{1.0, 0}, {1.5, 0}, {1.5, 0.1}, {1.0, 0.1}}};
  EXPECT_NEAR(inradius({ring}), 0.05, 0.0005);
}

}  // namespace
}  // namespace talus
