// Scene files: what is read, and what is refused.
#include "continuum/scene/scene.h"

#include <gmock/gmock.h>

#include <fstream>

#include "tests/test_folder.h"

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"

namespace talus {
namespace {

using ::testing::HasSubstr;

const std::string good_scene = read_file(TALUS_SOURCE_DIR "/tests/continuum/data/small_column.toml");

Scene read(const std::string& text) {
  const testing::TestFolder folder;
  const auto file = folder.path() / "scene.toml";
  std::ofstream(file) << text;
  return read_scene(file);
}

std::string with(const std::string& from, const std::string& to) {
  return testing::replaced(good_scene, from, to);
}

void expect_error(const std::string& text, const std::string& part) {
  EXPECT_THAT(testing::input_error([&] { read(text); }), HasSubstr(part));
}

TEST(Scene, ReadsAGoodOne) {
  const Scene scene = read(good_scene);
  EXPECT_EQ(scene.grid.cells, Eigen::Vector3i(20, 1, 10));
  EXPECT_TRUE(scene.grid.periodic[1]);
  EXPECT_NEAR(scene.sides[2][0].friction, 1.0, 1e-12);
  EXPECT_EQ(scene.sides[0][0].friction, 0.0);
  EXPECT_FALSE(scene.sides[0][1].wall);
  EXPECT_NEAR(scene.materials[0].friction, std::tan(M_PI / 6), 1e-12);
}

TEST(Scene, FillsItsBoxesWithTheRightMassAndTheSeedDecides) {
  const Scene scene = read(good_scene);
  const State a = initial_state(scene), b = initial_state(scene);
  EXPECT_EQ(a.particles.count(), 5 * 1 * 5 * 8);
  EXPECT_NEAR(a.particles.masses.sum(), 0.05 * 0.01 * 0.05 * 0.6 * 2500.0, 1e-12);
  EXPECT_EQ(a.particles.positions, b.particles.positions);
  const State c = initial_state(read(with("seed = 3", "seed = 4")));
  EXPECT_NE(a.particles.positions, c.particles.positions);
  EXPECT_GE(c.particles.positions.minCoeff(), 0.0);
  EXPECT_LE(c.particles.positions.row(2).maxCoeff(), 0.05);
}

TEST(Scene, RefusesWhatCannotBeMeant) {
  expect_error(with("friction_angle_deg = 30.0", "friction_angle_deg = 300.0"), "between 0 and 60");
  expect_error(with("max_volume_fraction = 0.6", "max_volume_fraction = 60"), "between 0.1 and 0.8");
  expect_error(with("size_m = [0.2, 0.01, 0.1]", "size_m = [0.205, 0.01, 0.1]"), "whole number of cells");
  expect_error(with("size_m = [0.2, 0.01, 0.1]", "size_m = [1e6, 1e3, 1e6]"), "at most");
  expect_error(with("upper_m = [0.05, 0.01, 0.05]", "upper_m = [0.5, 0.01, 0.05]"), "inside the domain");
  expect_error(with("material = \"sand\"", "material = \"gravel\""), "names no [[material]]");
  expect_error(with("periodic = [\"y\"]", "periodic = [\"z\"]"), "a periodic axis has no sides");
  expect_error(with("per_cell_axis = 2", "per_cell_axis = 1"), "between 2 and 8");
  expect_error(with("frame_interval_s = 0.01", "frame_interval_s = 1e-9"), "more than 1e+06 frames");
  expect_error(with("seed = 3", "sead = 3"), "is missing");
  expect_error(with("jitter = 0.5", "jitter = 0.5\njiter = 1"), "did you mean 'jitter'");
}

}  // namespace
}  // namespace talus
