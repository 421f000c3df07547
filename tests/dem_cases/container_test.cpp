#include "dem_cases/container.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>

#include "analysis/snapshot.h"
#include "dem_cases/falling_sphere.h"
#include "dem_cases/packing/packing.h"
#include "tests/dem_cases/case_files.h"

namespace talus::dem {
namespace {

const std::filesystem::path data = TALUS_SOURCE_DIR "/tests/dem_cases/data";

class EachKind : public ::testing::TestWithParam<const char*> {
 protected:
  EachKind()
      : case_(read_case(data / fmt_name())),
        container_(container_of(case_)),
        packing_(make_packing(case_, 1)) {}
  static std::string fmt_name() { return std::string("tiny_") + GetParam() + ".toml"; }

  Case case_;
  Container container_;
  Packing packing_;
};

TEST_P(EachKind, NoGrainStartsOutsideItsContainer) {
  for (Eigen::Index i = packing_.fixed_count; i < packing_.count(); ++i)
    EXPECT_EQ(leak(container_, packing_.positions.col(i), false), "")
        << packing_.positions.col(i).transpose();
}

TEST_P(EachKind, FillHasTheVolumeOfTheCase) {
  const double wanted = case_.protocol.volume_fraction * fill_volume(case_.geometry);
  EXPECT_NEAR(packing_.mobile_volume(), wanted, 0.01 * wanted);
}

TEST_P(EachKind, NoMobileGrainOverlapsAnother) {
  const double period = container_.periodic ? container_.upper.y() - container_.lower.y() : 1e9;
  for (Eigen::Index i = packing_.fixed_count; i < packing_.count(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      Eigen::Vector3d apart = packing_.positions.col(i) - packing_.positions.col(j);
      apart.y() -= period * std::round(apart.y() / period);
      ASSERT_GT(apart.norm(), packing_.radii[i] + packing_.radii[j]) << i << " and " << j;
    }
  }
}

TEST_P(EachKind, BoxHoldsTheWholeContainer) {
  for (const Plane& plane : container_.planes) {
    EXPECT_GE(plane.at, container_.lower[plane.axis]) << plane.name;
    EXPECT_LE(plane.at, std::max(container_.upper[plane.axis], packing_.top())) << plane.name;
  }
  for (const Shell& shell : container_.shells) {
    for (const Triangle& triangle : triangles_of(shell)) {
      for (const auto& corner : triangle) {
        EXPECT_TRUE((corner.array() >= container_.lower.array()).all()) << corner.transpose();
        EXPECT_TRUE((corner.array() <= container_.upper.array()).all()) << corner.transpose();
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EachKind,
                         ::testing::Values("column", "cylinder_collapse", "heap", "slot", "hourglass",
                                           "ledge", "impact"),
                         [](const auto& instance) { return instance.param; });

TEST(Container, RisingTubeStaysInItsBox) {
  const Case heap = read_case(data / "tiny_heap.toml");
  const Container container = container_of(heap);
  const double top = container.shells.front().profile.back().y() +
                     std::get<HeapGeometry>(heap.geometry).lift_speed * heap.protocol.run_time;
  EXPECT_GT(container.upper.z(), top);
}

// The sphere and what it throws up.
TEST(Container, BoxHasRoomForAFallingSphere) {
  const Case impact = read_case(data / "tiny_impact.toml");
  const auto sphere = falling_sphere(impact);
  ASSERT_TRUE(sphere);
  const Container container = container_of(impact);
  EXPECT_GT(container.upper.z(), sphere->centre.z() + sphere->radius);
  EXPECT_EQ(container.upper.z(), sphere->room);
  EXPECT_FALSE(falling_sphere(read_case(data / "tiny_heap.toml")));
}

// It has the case's speed where its lowest point passes the nominal height.
TEST(FallingSphere, IsAsFastAtTheBedAsTheCaseSays) {
  const Case impact = read_case(data / "tiny_impact.toml");
  const auto& geometry = std::get<ImpactGeometry>(impact.geometry);
  const auto sphere = falling_sphere(impact);
  const double fall = sphere->centre.z() - sphere->radius - geometry.height;
  EXPECT_NEAR(fall, 0.008, 1e-12);
  EXPECT_NEAR(std::sqrt(sphere->speed * sphere->speed + 2.0 * 9.81 * fall), geometry.impact_speed, 1e-12);
}

TEST(FallingSphere, TrackThatEndsTooSoonIsRefused) {
  const TestFolder folder;
  const Case impact = read_case(data / "tiny_impact.toml");
  const std::string start = "time_s,x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s\n0,0,0,0,0,0,0\n";
  write_file_atomically(folder.path() / analysis::body_track_file, start + "0.17,0,0,0,0,0,0\n");
  EXPECT_THROW(read_track(impact, folder.path()), analysis::SnapshotError);
  write_file_atomically(folder.path() / analysis::body_track_file, start + "0.18,0,0,0,0,0,0\n");
  EXPECT_EQ(read_track(impact, folder.path()).size(), 2u);
  EXPECT_TRUE(read_track(read_case(data / "tiny_heap.toml"), "/nowhere").empty());
}

TEST(Container, FindsLeaks) {
  const Container glass = container_of(read_case(data / "tiny_hourglass.toml"));
  EXPECT_EQ(leak(glass, {0.0, 0.0, 0.001}, false), "");
  EXPECT_EQ(leak(glass, {0.0, 0.0, -0.001}, false), "gate");
  EXPECT_EQ(leak(glass, {0.0, 0.0, -0.001}, true), "");
  EXPECT_EQ(leak(glass, {0.012, 0.0, 0.0}, true), "glass");  // through the throat's side
  EXPECT_EQ(leak(glass, {0.0, 0.0, -0.046}, true), "floor");
}

// A closed polygon about the axis: 48 corners a ring, two triangles a segment and profile step, all outside of a circle
// that the polygon holds.
TEST(Container, ShellIsAClosedRingOfTriangles) {
  const Shell tube{.name = "tube", .profile = {{0.01, 0.0}, {0.01, 0.02}}};
  const auto triangles = triangles_of(tube);
  ASSERT_EQ(triangles.size(), 2U * shell_segments);
  double area = 0.0;
  for (const Triangle& t : triangles) area += 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).norm();
  const double side = 2.0 * 0.01 * std::sin(M_PI / shell_segments);
  EXPECT_NEAR(area, shell_segments * side * 0.02, 1e-12);
}

TEST(Packing, SlotIsOpenToTheLastGrain) {
  const Case slot = read_case(data / "tiny_slot.toml");
  const Packing packing = make_packing(slot, 1);
  const auto& geometry = std::get<SlotGeometry>(slot.geometry);
  double left = 0.0, right = geometry.width;
  for (Eigen::Index i = 0; i < packing.fixed_count; ++i) {
    const double x = packing.positions(0, i), r = packing.radii[i];
    if (x < 0.5 * geometry.width)
      left = std::max(left, x + r);
    else
      right = std::min(right, x - r);
  }
  EXPECT_NEAR(right - left, geometry.opening, 1e-12);
}

}  // namespace
}  // namespace talus::dem
