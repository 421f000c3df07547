// Shapes in scene files: what each kind means, and what is refused.
#include "continuum/scene/read_shape.h"

#include <gmock/gmock.h>

#include <fstream>

#include "tests/continuum/solids/mesh_files.h"
#include "tests/test_folder.h"

namespace talus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class ReadShape : public ::testing::Test {
 protected:
  /// Reads shape = { `keys` } from a file of the test's folder.
  Shape read(const std::string& keys) {
    std::ofstream(folder_.path() / "scene.toml") << "\nshape = { " << keys << " }\n";
    return read_shape(CheckedTable::parse_file(folder_.path() / "scene.toml").table("shape"));
  }
  void expect_error(const std::string& keys, const std::string& key, const std::string& why) {
    EXPECT_THAT(testing::input_error([&] { read(keys); }),
                AllOf(HasSubstr("scene.toml:2: key 'shape." + key), HasSubstr(why)))
        << keys;
  }
  testing::TestFolder folder_;
};

TEST_F(ReadShape, Plane) {
  const Shape shape = read("kind = 'plane', point_m = [0, 0, 1], normal = [0, 3, 4]");
  EXPECT_NEAR(signed_distance(shape, {0, 0, 2}), 0.8, 1e-15);
  EXPECT_NEAR(signed_distance(shape, {7, 0, 0}), -0.8, 1e-15);
  expect_error("kind = 'plane', point_m = [0, 0, 1], normal = [0, 0, 0]", "normal", "must be a direction");
  expect_error("kind = 'plane', normal = [0, 0, 1]", "point_m", "is missing");
  expect_error("kind = 'plane', point_m = [0, 0, 0], normal = [0, 0, 1], hollow = true", "hollow",
               "is not a key");
}

TEST_F(ReadShape, Box) {
  const Shape shape = read("kind = 'box', lower_m = [0, 0, 0], upper_m = [4, 2, 2]");
  EXPECT_NEAR(signed_distance(shape, {5, 1, 1}), 1.0, 1e-15);
  EXPECT_NEAR(signed_distance(shape, {3.5, 1, 1}), -0.5, 1e-15);
  const Shape turned = read(
      "kind = 'box', lower_m = [0, 0, 0], upper_m = [4, 2, 2], rotation_axis = [0, 0, 2], rotation_angle_deg "
      "= 90");
  EXPECT_NEAR(signed_distance(turned, {2, 4, 1}), 1.0, 1e-14);  // as long along y now, about (2, 1, 1)
  EXPECT_NEAR(signed_distance(turned, {4, 1, 1}), 1.0, 1e-14);
  // A positive angle turns x towards y: the corner (4, 2) - (2, 1) goes to sqrt 2 / 2 (1, 3).
  const Shape eighth = read(
      "kind = 'box', lower_m = [0, 0, 0], upper_m = [4, 2, 2], rotation_axis = [0, 0, 1], rotation_angle_deg "
      "= 45");
  EXPECT_NEAR(signed_distance(eighth, Eigen::Vector3d(2 + std::sqrt(0.5), 1 + 3 * std::sqrt(0.5), 1)), 0.0,
              1e-14);
  expect_error("kind = 'box', lower_m = [0, 0, 0], upper_m = [4, 0, 2]", "upper_m", "must lie above lower_m");
  expect_error("kind = 'box', lower_m = [0, 0, 0], upper_m = [4, 2, 2], rotation_angle_deg = 45",
               "rotation_axis", "is missing");
  expect_error("kind = 'box', lower_m = [0, 0, 0], upper_m = [4, 2, 2], rotation_axis = [1, 0, 0]",
               "rotation_angle_deg", "is missing");
}

TEST_F(ReadShape, Sphere) {
  EXPECT_DOUBLE_EQ(signed_distance(read("kind = 'sphere', centre_m = [1, 0, 0], radius_m = 2"), {4, 0, 0}),
                   1.0);
  const Shape hollow = read("kind = 'sphere', centre_m = [1, 0, 0], radius_m = 2, hollow = true");
  EXPECT_DOUBLE_EQ(signed_distance(hollow, {4, 0, 0}), -1.0);
  expect_error("kind = 'sphere', centre_m = [1, 0, 0], radius_m = 0", "radius_m' = 0",
               "between 1e-09 and 1000000");
  expect_error("kind = 'sphere', center_m = [1, 0, 0], radius_m = 1", "centre_m", "has 'center_m' instead");
  expect_error("kind = 'sphere', centre_m = [1, 0, 0], radius_m = 2, hollow = 1", "hollow", "true or false");
}

TEST_F(ReadShape, Capsule) {
  const Shape shape = read("kind = 'capsule', from_m = [0, 0, 1], to_m = [0, 0, 3], radius_m = 0.5");
  EXPECT_DOUBLE_EQ(signed_distance(shape, {0, 0, 4}), 0.5);
  EXPECT_DOUBLE_EQ(signed_distance(shape, {2, 0, 2}), 1.5);
  expect_error("kind = 'capsule', from_m = [0, 0, 1], to_m = [0, 0, 1], radius_m = 0.5", "to_m",
               "must differ from from_m");
}

TEST_F(ReadShape, Cylinder) {
  const Shape shape =
      read("kind = 'cylinder', base_m = [1, 0, 0], axis = [2, 0, 0], radius_m = 0.5, height_m = 3");
  EXPECT_DOUBLE_EQ(signed_distance(shape, {5, 0, 0}), 1.0);
  EXPECT_DOUBLE_EQ(signed_distance(shape, {2, 0.75, 0}), 0.25);
  expect_error("kind = 'cylinder', base_m = [1, 0, 0], axis = [2, 0, 0], radius_m = 0.5, height_m = -3",
               "height_m' = -3", "between 1e-09 and 1000000");
  expect_error("kind = 'cylinder', base_m = [1, 0, 0], axis = [0, 0], radius_m = 0.5, height_m = 3", "axis",
               "three numbers");
}

TEST_F(ReadShape, Cone) {
  const Shape shape = read(
      "kind = 'cone', base_m = [0, 0, 0], axis = [0, 0, 1], base_radius_m = 0, top_radius_m = 3, height_m = "
      "4");
  EXPECT_NEAR(signed_distance(shape, {3, 0, 0}), 12.0 / 5.0, 1e-14);  // the wide end is up
  EXPECT_NEAR(signed_distance(shape, {2, 0, 5}), 1.0, 1e-14);
  expect_error(
      "kind = 'cone', base_m = [0, 0, 0], axis = [0, 0, 1], base_radius_m = 0, top_radius_m = 0, height_m = "
      "4",
      "top_radius_m' = 0", "between 1e-09 and 1000000");
}

TEST_F(ReadShape, Hourglass) {
  const std::string keys =
      "kind = 'hourglass', base_m = [0, 0, 0], axis = [0, 0, 1], bulb_radius_m = 0.5, bulb_height_m = 0.2, "
      "neck_radius_m = 0.1, neck_length_m = 0.3, cone_half_angle_deg = 45";
  const Shape shape = read(keys + ", hollow = true");
  EXPECT_NEAR(signed_distance(shape, {0, 0, 0.75}), 0.1,
              1e-14);  // in the neck, sand is that far from the glass
  EXPECT_NEAR(signed_distance(shape, {0.5, 0, 0.1}), 0.0, 1e-14);
  EXPECT_NEAR(signed_distance(shape, {0.3, 0, 0.4}), 0.0, 1e-14);  // on the cone, half-way up
  EXPECT_NEAR(signed_distance(shape, {0, 0, 1.6}), -0.1, 1e-14);
  expect_error(testing::replaced(keys, "neck_radius_m = 0.1", "neck_radius_m = 0.5"), "neck_radius_m' = 0.5",
               "less than bulb_radius_m");
  expect_error(testing::replaced(keys, "deg = 45", "deg = 90"), "cone_half_angle_deg' = 90",
               "between 1 and 89");
}

TEST_F(ReadShape, Profile) {
  const Shape shape = read(
      "kind = 'profile', base_m = [0, 0, 1], axis = [0, 0, 1], points_m = [[1, 0], [2, 0], [2, 1], [1.0, "
      "1]]");
  EXPECT_DOUBLE_EQ(signed_distance(shape, {0, 0, 1.5}), 1.0);
  EXPECT_DOUBLE_EQ(signed_distance(shape, {1.75, 0, 1.5}), -0.25);
  const auto with = [](const std::string& points) {
    return "kind = 'profile', base_m = [0, 0, 1], axis = [0, 0, 1], points_m = " + points;
  };
  expect_error(with("[[-1, 0], [2, 0], [2, 1]]"), "points_m' = [",
               "first number of each pair must be between 0 and 1000000");
  expect_error(with("[[1, 0], [2, 1], [2, 0], [1, 1]]"), "points_m", "must not cross or touch itself");
  expect_error(with("[[1, 0], [2, 1]]"), "points_m", "at least three corners");
}

TEST_F(ReadShape, MeshBesideTheSceneFile) {
  testing::write_binary_stl(folder_.path() / "cube.stl", testing::box_mesh({0, 0, 0}, {1000, 1000, 1000}));
  const Shape shape = read("kind = 'mesh', file = 'cube.stl', scale = 0.001, offset_m = [0, 0, 1]");
  EXPECT_NEAR(signed_distance(shape, {0.5, 0.5, 2.5}), 0.5, 1e-12);
  EXPECT_NEAR(signed_distance(read("kind = 'mesh', file = 'cube.stl'"), {500, 500, 1001}), 1.0, 1e-12);
  const std::string absolute = (folder_.path() / "cube.stl").string();
  EXPECT_NO_THROW(read("kind = 'mesh', file = '" + absolute + "'"));
  expect_error("kind = 'mesh', file = 'cube.stl', scale = 0", "scale' = 0", "between 1e-09 and");
  expect_error("kind = 'mesh', file = 'funnel.stl'", "file' = 'funnel.stl'",
               (folder_.path() / "funnel.stl").string() + ": no such file");
}

TEST_F(ReadShape, UnknownKindsAndKeysAreErrors) {
  expect_error("kind = 'ball', centre_m = [0, 0, 0]", "kind' = 'ball'",
               "one of: plane, box, sphere, capsule, cylinder");
  expect_error("centre_m = [0, 0, 0]", "kind", "is missing");
  expect_error("kind = 'sphere', centre_m = [1, 0, 0], radius_m = 2, height_m = 1", "height_m",
               "is not a key");
}

}  // namespace
}  // namespace talus
