// Scene files: what is read, and what is refused.
#include "continuum/scene/scene.h"

#include <gmock/gmock.h>

#include <fstream>

#include "tests/fresh_folder.h"

#include "continuum/scene/checked_table.h"

namespace talus {
namespace {

using ::testing::HasSubstr;

constexpr const char* good_scene = R"(schema = 1
[domain]
origin_m = [0.0, 0.0, 0.0]
size_m = [0.4, 0.01, 0.2]
cell_size_m = 0.01
gravity_m_s2 = [0.0, 0.0, -9.81]
periodic = ["y"]
z_lower = { kind = "wall", friction_angle_deg = 45.0 }
[[material]]
name = "sand"
grain_density_kg_m3 = 2500.0
max_volume_fraction = 0.6
friction_angle_deg = 30.0
[[box]]
material = "sand"
lower_m = [0.0, 0.0, 0.0]
upper_m = [0.1, 0.01, 0.05]
[particles]
per_cell_axis = 2
jitter = 0.5
seed = 3
[time]
end_s = 0.1
frame_interval_s = 0.01
)";

Scene read(const std::string& text) {
  const auto file = testing::fresh_folder("scene") / "scene.toml";
  std::ofstream(file) << text;
  return read_scene(file);
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = good_scene;
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos);
  return text.replace(at, from.size(), to);
}

void expect_error(const std::string& text, const std::string& part) {
  try {
    read(text);
    ADD_FAILURE() << "accepted; expected an error with: " << part;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(part));
  }
}

TEST(Scene, ReadsAGoodOne) {
  const Scene scene = read(good_scene);
  EXPECT_EQ(scene.grid.cells, Eigen::Vector3i(40, 1, 20));
  EXPECT_TRUE(scene.grid.periodic[1]);
  EXPECT_NEAR(scene.sides[2][0].friction, 1.0, 1e-12);
  EXPECT_FALSE(scene.sides[0][0].wall);
  EXPECT_NEAR(scene.materials[0].friction, std::tan(M_PI / 6), 1e-12);
}

TEST(Scene, FillsItsBoxesWithTheRightMassAndTheSeedDecides) {
  const Scene scene = read(good_scene);
  const State a = initial_state(scene), b = initial_state(scene);
  EXPECT_EQ(a.particles.count(), 10 * 1 * 5 * 8);
  EXPECT_NEAR(a.particles.masses.sum(), 0.1 * 0.01 * 0.05 * 0.6 * 2500.0, 1e-12);
  EXPECT_EQ(a.particles.positions, b.particles.positions);
  const State c = initial_state(read(with("seed = 3", "seed = 4")));
  EXPECT_NE(a.particles.positions, c.particles.positions);
  EXPECT_GE(c.particles.positions.minCoeff(), 0.0);
  EXPECT_LE(c.particles.positions.row(2).maxCoeff(), 0.05);
}

TEST(Scene, RefusesWhatCannotBeMeant) {
  expect_error(with("friction_angle_deg = 30.0", "friction_angle_deg = 300.0"), "between 0 and 60");
  expect_error(with("max_volume_fraction = 0.6", "max_volume_fraction = 60"), "between 0.1 and 0.8");
  expect_error(with("size_m = [0.4, 0.01, 0.2]", "size_m = [0.405, 0.01, 0.2]"), "whole number of cells");
  expect_error(with("size_m = [0.4, 0.01, 0.2]", "size_m = [1e6, 1e3, 1e6]"), "at most");
  expect_error(with("upper_m = [0.1, 0.01, 0.05]", "upper_m = [0.5, 0.01, 0.05]"), "inside the domain");
  expect_error(with("material = \"sand\"", "material = \"gravel\""), "names no [[material]]");
  expect_error(with("periodic = [\"y\"]", "periodic = [\"z\"]"), "a periodic axis has no sides");
  expect_error(with("per_cell_axis = 2", "per_cell_axis = 1"), "between 2 and 8");
  expect_error(with("seed = 3", "sead = 3"), "is missing");
  expect_error(with("jitter = 0.5", "jitter = 0.5\njiter = 1"), "did you mean 'jitter'");
}

}  // namespace
}  // namespace talus
