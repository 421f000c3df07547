// Meshes: the same solid from each file format, against its formula; and every file that is refused.
#include "continuum/solids/mesh.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <random>
#include <thread>

#include "continuum/files/atomic_file.h"
#include "continuum/solids/shape.h"
#include "tests/continuum/solids/mesh_files.h"
#include "tests/test_folder.h"

namespace talus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::Triangles;

const Triangles unit_cube = testing::box_mesh({0, 0, 0}, {1, 1, 1});

class MeshTest : public ::testing::Test {
 protected:
  Eigen::Vector3d random_point() {
    return {coordinate_(random_), coordinate_(random_), coordinate_(random_)};
  }

  /// The solid from each of the three formats.
  std::vector<Mesh> in_every_format(const Triangles& triangles) {
    testing::write_text_stl(path("text.stl"), triangles);
    testing::write_binary_stl(path("binary.STL"), triangles);
    testing::write_obj(path("surface.obj"), triangles);
    return {read_mesh(path("text.stl")), read_mesh(path("binary.STL")), read_mesh(path("surface.obj"))};
  }
  std::string error_for(const Triangles& triangles) {
    testing::write_text_stl(path("bad.stl"), triangles);
    return testing::input_error([&] { read_mesh(path("bad.stl")); });
  }
  std::string error_for_text(const std::string& name, const std::string& text) {
    std::ofstream(path(name)) << text;
    return testing::input_error([&] { read_mesh(path(name)); });
  }
  std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }

  testing::TestFolder folder_;
  std::mt19937_64 random_{11};
  std::uniform_real_distribution<double> coordinate_{-1.5, 1.5};
};

TEST_F(MeshTest, CubeOfAnyFormatIsABox) {
  const Shape box{Box{{0.25, 0.0, -0.25}, {0.5, 0.25, 0.75}}};  // exact in single precision
  for (const Mesh& mesh : in_every_format(testing::box_mesh({-0.25, -0.25, -1.0}, {0.75, 0.25, 0.5}))) {
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector3d at = random_point();
      EXPECT_NEAR(signed_distance(mesh, at), signed_distance(box, at), 1e-14) << at.transpose();
    }
    EXPECT_LE((bounds(mesh).min() - bounds(box).min()).norm(), 1e-15);
    EXPECT_LE((bounds(mesh).max() - bounds(box).max()).norm(), 1e-15);
  }
}

TEST_F(MeshTest, FineSphereOfAnyFormatIsASphere) {
  const Shape sphere{Sphere{{0.1, 0.2, -0.1}, 0.8}};
  constexpr int rows = 48;
  // Chords of pi/rows both ways: a flat cell with half diagonal 0.8 * (pi/rows) / sqrt 2 sinks below the sphere by this.
  const double sagitta = 0.8 * (1.0 - std::cos(std::numbers::pi / rows / std::sqrt(2.0)));
  for (const Mesh& mesh : in_every_format(testing::sphere_mesh({0.1, 0.2, -0.1}, 0.8, rows))) {
    double largest = 0.0;
    for (int i = 0; i < 1000; ++i) {
      const Eigen::Vector3d at = random_point();
      const double difference = signed_distance(mesh, at) - signed_distance(sphere, at);
      EXPECT_GE(difference, -1e-7) << at.transpose();  // inscribed, but for single precision
      EXPECT_LE(difference, 1.01 * sagitta + 1e-7) << at.transpose();
      largest = std::max(largest, difference);
    }
    EXPECT_GT(largest, 0.5 * sagitta);  // it is the mesh that is measured
  }
}

TEST_F(MeshTest, ScaleComesBeforeOffset) {
  testing::write_binary_stl(path("cube.stl"), unit_cube);
  const Mesh mesh = read_mesh(path("cube.stl"), 0.5, {1, 2, 3});
  EXPECT_DOUBLE_EQ(signed_distance(mesh, {1.25, 2.25, 3.25}), -0.25);
  EXPECT_DOUBLE_EQ(signed_distance(mesh, {1.25, 2.25, 4.5}), 1.0);
  EXPECT_EQ(bounds(mesh).min(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(bounds(mesh).max(), Eigen::Vector3d(1.5, 2.5, 3.5));
}

TEST_F(MeshTest, QuadsAndGroupsOfObjFilesAreOneSurface) {
  std::ofstream(path("quads.obj"))
      << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
         "o ends\nf 4 3 2 1\nf 5 6 7 8\no sides\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n"
         "f 4 1 5 8\n";
  EXPECT_DOUBLE_EQ(signed_distance(read_mesh(path("quads.obj")), {0.5, 0.5, 0.25}), -0.25);
}

TEST_F(MeshTest, CavitiesAndSeparatePartsBelongToTheSolid) {
  const auto meshes = in_every_format(
      testing::together(testing::together(testing::box_mesh({0, 0, 0}, {4, 4, 4}),
                                          testing::flipped(testing::box_mesh({1, 1, 1}, {3, 3, 3}))),
                        testing::box_mesh({6, 0, 0}, {7, 1, 1})));
  for (const Mesh& mesh : meshes) {
    EXPECT_DOUBLE_EQ(signed_distance(mesh, {2, 2, 2}), 1.0);
    EXPECT_DOUBLE_EQ(signed_distance(mesh, {0.25, 2, 2}), -0.25);
    EXPECT_DOUBLE_EQ(signed_distance(mesh, {6.5, 0.5, 0.5}), -0.5);
    EXPECT_DOUBLE_EQ(signed_distance(mesh, {5, 0.5, 0.5}), 1.0);
  }
}

TEST_F(MeshTest, ThreadsMayAskAtTheSameTime) {
  testing::write_binary_stl(path("torus.stl"), testing::torus_mesh(0.9, 0.4, 16));
  const Mesh mesh = read_mesh(path("torus.stl")), asked_alone = read_mesh(path("torus.stl"));
  std::vector<Eigen::Vector3d> points(500);
  for (auto& point : points) point = random_point();
  std::vector<std::vector<double>> distances(4);
  {
    std::vector<std::jthread> threads;
    for (auto& found : distances) {
      threads.emplace_back([&] {
        for (const auto& point : points) found.push_back(signed_distance(mesh, point));
      });
    }
  }
  std::vector<double> expected;
  for (const auto& point : points) expected.push_back(signed_distance(asked_alone, point));
  for (const auto& found : distances) EXPECT_EQ(found, expected);
}

TEST_F(MeshTest, RefusesWhatIsNoMeshFile) {
  EXPECT_THAT(testing::input_error([&] { read_mesh("/nowhere/funnel.stl"); }),
              AllOf(HasSubstr("/nowhere/funnel.stl"), HasSubstr("no such file")));
  std::filesystem::create_directory(path("folder.stl"));
  EXPECT_THAT(testing::input_error([&] { read_mesh(path("folder.stl")); }), HasSubstr("no such file"));
  EXPECT_THAT(error_for_text("funnel.ply", "ply\n"),
              AllOf(HasSubstr("funnel.ply"), HasSubstr(".stl or .obj")));
  EXPECT_THAT(error_for_text("empty.stl", ""), AllOf(HasSubstr("empty.stl"), HasSubstr("cannot be read")));
  EXPECT_THAT(error_for_text("letter.stl", "Dear reader,\n"), HasSubstr("cannot be read"));
  EXPECT_THAT(error_for_text("letter.obj", "Dear reader,\n"), HasSubstr("letter.obj"));
}

TEST_F(MeshTest, RefusesHalfAFile) {
  testing::write_binary_stl(path("half.stl"), unit_cube);
  std::filesystem::resize_file(path("half.stl"), 400);
  EXPECT_THAT(testing::input_error([&] { read_mesh(path("half.stl")); }), HasSubstr("cannot be read"));
  testing::write_text_stl(path("half.stl"), unit_cube);
  std::filesystem::resize_file(path("half.stl"), 700);
  EXPECT_THAT(testing::input_error([&] { read_mesh(path("half.stl")); }), HasSubstr("half.stl"));
}

TEST_F(MeshTest, TellsTheLineOfATextThatIsWrong) {
  const std::string facet = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n";
  EXPECT_THAT(error_for_text("bad.stl", facet + "vertex 1 x 0\n"),
              HasSubstr("bad.stl:5: cannot be read as a mesh: 'x' is no number"));
  EXPECT_THAT(error_for_text("bad.stl", facet + "vertex 1 0\n"), HasSubstr("bad.stl:5"));
  EXPECT_THAT(error_for_text("bad.stl", facet + "endloop\nendfacet\n"),
              HasSubstr("a facet without three vertices"));
  EXPECT_THAT(error_for_text("bad.stl", facet + "facet\n"), HasSubstr("'facet' where none can be"));
  EXPECT_THAT(error_for_text("bad.stl", facet), HasSubstr("ends before 'endsolid'"));
  EXPECT_THAT(error_for_text("bad.obj", "v 0 0 0\nv 1 0\n"),
              HasSubstr("bad.obj:2: cannot be read as a mesh: 'v' needs three numbers"));
  for (const char* face :
       {"f 1 2 4", "f 1 2 -4", "f 0 1 2", "f 1 2 99999999999999999999", "f 1 2 3.5", "f 1 2 x"})
    EXPECT_THAT(error_for_text("bad.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\n") + face),
                AllOf(HasSubstr("bad.obj:4"), HasSubstr("names none of the 3 vertices")))
        << face;
  EXPECT_THAT(error_for_text("bad.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n"), HasSubstr("a face has 2 corners"));
}

TEST_F(MeshTest, ReadsWhatOtherProgramsWrite) {
  // Upper case, carriage returns, signs, joined lines, texture and normals, corners counted from the end, vertex colours.
  std::ofstream(path("other.obj"))
      << "# made by hand\r\nmtllib x.mtl\r\nv +0 0 0 1 1 1\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\nv 0 0 1\r\nv "
         "1 0 1\r\nv 1 1 1e0\r\nv 0 1 1\r\n"
         "vt 0 0\r\nvn 0 0 1\r\nf 4/1/1 3/1/1 2/1/1 1/1/1\r\nf -4 -3 \\\r\n-2 -1\r\nf 1//1 2//1 6//1 "
         "5//1\r\nf 2 3 7 6\r\nf 3 4 8 7\r\nf 4 1 5 8\r\n";
  EXPECT_DOUBLE_EQ(signed_distance(read_mesh(path("other.obj")), {0.5, 0.5, 0.25}), -0.25);
  testing::write_text_stl(path("lower.stl"), unit_cube);
  std::string text = read_file(path("lower.stl"));
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  std::ofstream(path("upper.stl")) << text;
  EXPECT_DOUBLE_EQ(signed_distance(read_mesh(path("upper.stl")), {0.5, 0.5, 0.25}), -0.25);
  // "solid" at the start of a binary file says nothing.
  testing::write_binary_stl(path("binary.stl"), unit_cube);
  std::fstream(path("binary.stl"), std::ios::in | std::ios::out | std::ios::binary).write("solid", 5);
  EXPECT_DOUBLE_EQ(signed_distance(read_mesh(path("binary.stl")), {0.5, 0.5, 0.25}), -0.25);
}

// Found by fuzzing: CGAL crashed on them.
TEST_F(MeshTest, VerticesThatNoTriangleHasAreNoPartOfTheSolid) {
  testing::write_obj(path("far.obj"), unit_cube);
  std::ofstream(path("far.obj"), std::ios::app) << "v 9 9 9\nv -9 -9 -9\nv 9 9 9\nv 9 9 9\nf -1 -2 -4\n";
  const Mesh mesh = read_mesh(path("far.obj"));
  EXPECT_DOUBLE_EQ(signed_distance(mesh, {0.5, 0.5, 0.25}), -0.25);
  EXPECT_EQ(bounds(mesh).max(), Eigen::Vector3d(1, 1, 1));
}

TEST_F(MeshTest, FacesWithManyCornersMustBeSeenFromOneOfThem) {
  // A prism on a pentagon: its fifth corner on the way from the fourth to the first, where no flat triangle must be made, or a dent.
  const auto prism =
      [&](const std::string& fifth) {
        std::ofstream(path("prism.obj"))
            << "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv " << fifth
            << " 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nv " << fifth
            << " 1\nf 5 4 3 2 1\nf 6 7 8 9 10\nf 1 2 7 6\nf 2 3 8 7\nf 3 4 9 8\nf 4 5 10 9\nf 5 1 6 10\n";
        return read_mesh(path("prism.obj"));
      };
  EXPECT_DOUBLE_EQ(signed_distance(prism("0 0.5"), {0.125, 0.5, 0.5}), -0.125);
  EXPECT_GT(signed_distance(prism("0.6 0.5"), {0.25, 0.5, 0.5}), 0.0);
  const std::string u =
      "v 0 0 0\nv 3 0 0\nv 3 2 0\nv 2 2 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6 7 8\n";
  EXPECT_THAT(error_for_text("u.obj", u), AllOf(HasSubstr("u.obj:9"), HasSubstr("triangulate it")));
}

TEST_F(MeshTest, RefusesHugeFilesBeforeReadingThem) {
  testing::write_binary_stl(path("huge.stl"), unit_cube);
  std::filesystem::resize_file(path("huge.stl"), 5'000'000'000);  // a hole, which takes no disk
  EXPECT_THAT(testing::input_error([&] { read_mesh(path("huge.stl")); }),
              HasSubstr("has 5000 MB; at most 400"));
  // A count that the file does not hold.
  testing::write_binary_stl(path("claims.stl"), unit_cube);
  const std::uint32_t claimed = 0xffffffff;
  std::fstream claims(path("claims.stl"), std::ios::in | std::ios::out | std::ios::binary);
  claims.seekp(80).write(reinterpret_cast<const char*>(&claimed), sizeof claimed);
  claims.close();
  EXPECT_THAT(testing::input_error([&] { read_mesh(path("claims.stl")); }),
              HasSubstr("4294967295 triangles that it claims"));
}

TEST_F(MeshTest, RefusesSurfacesWithoutArea) {
  EXPECT_THAT(error_for({}), HasSubstr("bad.stl"));
  EXPECT_THAT(error_for({{Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(2, 2, 2)}}),
              HasSubstr("no triangle with an area"));
  EXPECT_THAT(error_for({{Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 1, 1)}}),
              HasSubstr("no triangle with an area"));
  Triangles with_flat = unit_cube;
  with_flat.push_back({Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.5, 0, 0), Eigen::Vector3d(1, 0, 0)});
  EXPECT_THAT(error_for(with_flat), HasSubstr("1 triangle(s) whose three corners lie on one line"));
}

TEST_F(MeshTest, RefusesLinesBesideTheSurface) {
  EXPECT_THAT(error_for_text("lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl 1 2\n"),
              HasSubstr("lines or points"));
}

TEST_F(MeshTest, RefusesVerticesThatAreNotFinite) {
  Triangles bad = unit_cube;
  bad[3][1].y() = std::numeric_limits<double>::quiet_NaN();
  testing::write_binary_stl(path("nan.stl"), bad);
  EXPECT_THAT(testing::input_error([&] { read_mesh(path("nan.stl")); }),
              AllOf(HasSubstr("nan.stl"), HasSubstr("must be finite")));
  bad[3][1].y() = std::numeric_limits<double>::infinity();
  testing::write_binary_stl(path("inf.stl"), bad);
  EXPECT_THAT(testing::input_error([&] { read_mesh(path("inf.stl")); }), HasSubstr("must be finite"));
  testing::write_binary_stl(path("cube.stl"), unit_cube);
  EXPECT_THAT(testing::input_error([&] {
                read_mesh(path("cube.stl"), 1e308, {1e308, 0, 0});
              }),
              HasSubstr("after scale and offset"));
}

TEST_F(MeshTest, RefusesOpenSurfacesAndCountsTheirEdges) {
  Triangles open = unit_cube;
  open.pop_back();
  EXPECT_THAT(error_for(open), AllOf(HasSubstr("not closed: 3 edge(s)"), HasSubstr("fill holes")));
  open.pop_back();
  EXPECT_THAT(error_for(open), HasSubstr("not closed: 4 edge(s)"));
}

TEST_F(MeshTest, RefusesSurfacesThatAreNotManifold) {
  // Cubes that share one edge, cubes that share one vertex.
  EXPECT_THAT(error_for(testing::together(unit_cube, testing::box_mesh({1, 1, 0}, {2, 2, 1}))),
              HasSubstr("not manifold: 1 edge(s)"));
  EXPECT_THAT(error_for(testing::together(unit_cube, testing::box_mesh({1, 1, 1}, {2, 2, 2}))),
              HasSubstr("not manifold: parts of the surface touch in a vertex"));
}

TEST_F(MeshTest, RefusesNormalsThatPointInwards) {
  EXPECT_THAT(error_for(testing::flipped(unit_cube)), HasSubstr("inside out"));
  Triangles one_flipped = unit_cube;
  std::swap(one_flipped[4][0], one_flipped[4][1]);
  EXPECT_THAT(error_for(one_flipped), HasSubstr("face opposite ways across 3 edge(s)"));
  // A part beside the cube, and a cavity that is oriented like a part.
  EXPECT_THAT(
      error_for(testing::together(unit_cube, testing::flipped(testing::box_mesh({2, 2, 2}, {3, 3, 3})))),
      HasSubstr("in part"));
  EXPECT_THAT(
      error_for(testing::together(unit_cube, testing::box_mesh({0.25, 0.25, 0.25}, {0.75, 0.75, 0.75}))),
      HasSubstr("in part"));
}

TEST_F(MeshTest, RefusesSurfacesThatIntersectThemselves) {
  EXPECT_THAT(error_for(testing::together(unit_cube, testing::box_mesh({0.5, 0.5, 0.5}, {2, 2, 2}))),
              AllOf(HasSubstr("intersects itself"), HasSubstr("boolean union")));
}

}  // namespace
}  // namespace talus
