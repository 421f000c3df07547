// What pictures are put together from: frames by number, colours, the camera, bodies.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "continuum/files/atomic_file.h"
#include "continuum/render/camera.h"
#include "continuum/render/colours.h"
#include "continuum/render/run_folder.h"
#include "tests/continuum/scenes.h"
#include "tests/test_folder.h"

namespace talus {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::input_error;
using testing::TestFolder;

TEST(ChosenFrames, AreListsAndRanges) {
  EXPECT_THAT(chosen_frames("all", 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(chosen_frames("last", 3), ElementsAre(2));
  EXPECT_THAT(chosen_frames("4,0,2-last:3,2", 9), ElementsAre(0, 2, 4, 5, 8));
  for (const char* wrong : {"", "a", "1,", "-1", "2-1", "0-2:0", "1 2", "0x1", "1-", "99999999999999999999"})
    EXPECT_THAT(input_error([&] { chosen_frames(wrong, 3); }), HasSubstr("allowed are all")) << wrong;
  EXPECT_THAT(input_error([&] { chosen_frames("0,3", 3); }), HasSubstr("the run has frames 0 to 2"));
}

TEST(Colours, AreOfAMaterialAndOfAPointForLife) {
  const std::vector<Material> materials{{"sand", 2500.0, 0.6, 0.5}, {"basalt", 3000.0, 0.6, 0.5}};
  const auto colours = colours_of(materials, {"basalt=#0080ff"});
  EXPECT_EQ(colours[0], colours_of(materials, {})[0]);
  EXPECT_EQ(colours[1], Colour(0.0, 128.0 / 255.0, 1.0));
  for (const char* wrong : {"slate=#000000", "basalt", "basalt=red", "basalt=#12345", "basalt=#12345g"})
    EXPECT_THAT(input_error([&] { colours_of(materials, {wrong}); }), HasSubstr(wrong));
  std::vector<int> used(shades, 0);
  double mean_size = 0.0;
  constexpr std::uint32_t points = 32000;
  for (std::uint32_t identity = 0; identity < points; ++identity) {
    ++used.at(static_cast<std::size_t>(shade_of(identity)));
    mean_size += size_of(identity) / points;
  }
  EXPECT_THAT(used, ::testing::Each(::testing::AllOf(::testing::Gt(800), ::testing::Lt(1200))));
  EXPECT_NEAR(mean_size, 1.0, 0.005);
}

/// Where a camera sees a point, in the picture's half widths and half heights from its middle.
Eigen::Vector2d seen(const Camera& camera, double aspect, const Vector3d& point) {
  const Vector3d forward = (camera.look_at - camera.position).normalized();
  const Vector3d right = forward.cross(camera.up).normalized();
  const Vector3d at = point - camera.position;
  const double scale = 1.0 / (forward.dot(at) * std::tan(camera.field_of_view * std::numbers::pi / 360.0));
  return {scale * right.dot(at), scale * aspect * right.cross(forward).dot(at)};
}

TEST(Camera, SeesAllOfItsSubjectAndNotFromTooFar) {
  const Scene scene = testing::box_scene({20, 10, 8}, {5.0, 4.0, 8.0}, 0.01, 0.5);
  for (const double aspect : {0.5, 1.0, 16.0 / 9.0}) {
    const Eigen::Matrix3Xd subject = 0.05 * Eigen::Matrix3Xd::Random(3, 500);
    const Camera camera = camera_for(scene, subject, aspect, {});
    double widest = 0.0;
    for (const auto& point : subject.colwise())
      widest = std::max(widest, seen(camera, aspect, point).cwiseAbs().maxCoeff());
    EXPECT_LT(widest, 0.9);
    EXPECT_GT(widest, 0.8);
    EXPECT_GT(camera.position[2], camera.look_at[2]);  // from above
  }
}

TEST(Camera, StandsOverTheGroundThatGravityMakes) {
  Scene scene = testing::box_scene({20, 10, 8}, {5.0, 4.0, 8.0}, 0.01, 0.5);
  scene.gravity = {0.0, -9.81, 0.0};
  const ViewAxes axes = view_axes(scene);
  EXPECT_EQ(axes.up, Vector3d::UnitY());
  EXPECT_NEAR(axes.right.cross(axes.away).dot(axes.up), 1.0, 1e-12);  // right-handed: nothing is mirrored
  EXPECT_EQ(std::abs(axes.away[2]), 1.0);                             // the shortest side is the depth
}

TEST(Camera, StandsWhereItIsTold) {
  const Scene scene = testing::box_scene({20, 10, 8}, {5.0, 4.0, 8.0}, 0.01, 0.5);
  const Eigen::Matrix3Xd subject = Eigen::Matrix3Xd::Random(3, 10);
  CameraWish wish;
  wish.position = Vector3d(1.0, 2.0, 3.0);
  wish.look_at = Vector3d(1.0, 2.0, 0.0);
  const Camera down = camera_for(scene, subject, 1.0, wish);
  EXPECT_EQ(down.position, *wish.position);
  EXPECT_NEAR(down.up.dot(Vector3d::UnitZ()), 0.0, 1e-12);  // a picture has no up along the line of sight
  wish.look_at = wish.position;
  EXPECT_THAT(input_error([&] { camera_for(scene, subject, 1.0, wish); }), HasSubstr("same place"));
}

const std::string header = "time_s,body,x_m,y_m,z_m,qw,qx,qy,qz,vx_m_s\n";

/// A triangle, as a file of one.
void write_triangle(const std::filesystem::path& file) {
  std::filesystem::create_directories(file.parent_path());
  write_file_atomically(file,
                        "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                        "endloop\nendfacet\nendsolid s\n");
}

TEST(Bodies, AreWhereTheirLatestRowSays) {
  const TestFolder folder;
  EXPECT_TRUE(read_bodies(folder.path()).empty());
  write_file_atomically(folder.path() / "bodies.csv",
                        header +
                            "0,ball,1,2,3,1,0,0,0,5\n0.1,ball,1,2,2.5,0.70710678,0,0,0.70710678,5\n"
                            "0.05,axle,0,0,0,1,0,0,0\n");
  EXPECT_THAT(input_error([&] { read_bodies(folder.path()); }), HasSubstr("axle.stl"));
  for (const char* name : {"ball", "axle"})
    write_triangle(folder.path() / "bodies" / (std::string(name) + ".stl"));
  const auto bodies = read_bodies(folder.path());
  ASSERT_EQ(bodies.size(), 2u);
  EXPECT_EQ(bodies[1].name, "ball");
  EXPECT_EQ(bodies[1].surface.corners.size(), 3u);
  EXPECT_EQ(placement_at(bodies[1], 0.099).translation(), Vector3d(1.0, 2.0, 3.0));
  const Vector3d turned = placement_at(bodies[1], 0.1) * Vector3d::UnitX();  // by 90 degrees about z
  EXPECT_LT((turned - Vector3d(1.0, 3.0, 2.5)).norm(), 1e-6);
  EXPECT_THAT(input_error([&] { placement_at(bodies[0], 0.0); }), HasSubstr("'axle'"));
}

TEST(Bodies, WrongRowsAreTold) {
  const TestFolder folder;
  const auto error_of = [&](const std::string& rows) {
    write_file_atomically(folder.path() / "bodies.csv", rows);
    return input_error([&] { read_bodies(folder.path()); });
  };
  EXPECT_THAT(error_of("time,body\n"), HasSubstr("bodies.csv:1: must be time_s,body"));
  EXPECT_THAT(error_of(header + "0,ball,1,2,3,1,0,0\n"), HasSubstr("bodies.csv:2: must hold"));
  EXPECT_THAT(error_of(header + "0,ball,1,2,x,1,0,0,0\n"), HasSubstr("'x' is not a number"));
  EXPECT_THAT(error_of(header + "0,ball,1,2,3,1,1,0,0\n"), HasSubstr("quaternion's length is 1.41"));
  EXPECT_THAT(error_of(header + "1,ball,1,2,3,1,0,0,0\n0,ball,1,2,3,1,0,0,0\n"),
              HasSubstr("bodies.csv:3: goes back"));
}

}  // namespace
}  // namespace talus
