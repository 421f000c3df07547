// What a scene is warned of, with its figures; and what it is said to need, against what it takes.
#include "continuum/scene/warnings.h"

#include <gmock/gmock.h>

#include <fstream>

#include "continuum/files/atomic_file.h"
#include "continuum/files/memory.h"
#include "tests/continuum/scenes.h"
#include "tests/test_folder.h"

namespace talus {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string good_scene = read_file(TALUS_SOURCE_DIR "/tests/continuum/data/small_column.toml");

Scene read(const std::string& text) {
  const testing::TestFolder folder;
  const auto file = folder.path() / "scene.toml";
  std::ofstream(file) << text;
  return read_scene(file);
}

std::vector<std::string> warnings(const std::string& text, double memory = 1e12) {
  const Scene scene = read(text);
  return scene_warnings(scene, scene_cost(scene), memory);
}

std::string with(const std::string& from, const std::string& to) {
  return testing::replaced(good_scene, from, to);
}

TEST(SceneWarnings, AreNoneForASoundScene) { EXPECT_THAT(warnings(good_scene), IsEmpty()); }

TEST(SceneWarnings, TellOfNarrowOpenings) {
  const std::string floor =
      "[[wall]]\nshape = { kind = \"box\", lower_m = [-1.0, -1.0, 0.06], upper_m = [0.08, 1.0, 0.07] "
      "}\nrough = true\n"
      "[[wall]]\nshape = { kind = \"box\", lower_m = [0.105, -1.0, 0.06], upper_m = [1.0, 1.0, 0.07] "
      "}\nrough = true\n";
  // Another way round the floor would be wide enough.
  EXPECT_THAT(warnings(good_scene + floor), IsEmpty());
  const std::string closed =
      with("z_lower = ", "x_upper = { kind = \"wall\", friction_angle_deg = 0.0 }\nz_lower = ");
  EXPECT_THAT(warnings(closed + floor),
              ElementsAre(AllOf(HasSubstr("scene.toml: key 'wall'"), HasSubstr("0.025 m"),
                                HasSubstr("2.5 cells"), HasSubstr("cell_size_m = 0.00417"))));
}

TEST(SceneWarnings, TellOfThinSandAndSmallBodies) {
  EXPECT_THAT(warnings(with("upper_m = [0.05, 0.01, 0.05]", "upper_m = [0.05, 0.01, 0.008]")),
              ElementsAre(AllOf(HasSubstr("sand[0].shape"), HasSubstr("0.008 m thick, 0.8 cells"))));
  EXPECT_THAT(warnings(with("upper_m = [0.05, 0.01, 0.05]", "upper_m = [0.05, 0.01, 0.01]")), IsEmpty());
  const auto ball = [](const char* radius) {
    return std::string(
               "[[body]]\nname = \"ball\"\nshape = { kind = \"sphere\", centre_m = [0.1, 0.005, 0.06], "
               "radius_m = ") +
           radius + " }\ndensity_kg_m3 = 2500.0\nfriction_angle_deg = 20.0\n";
  };
  EXPECT_THAT(warnings(good_scene + ball("0.004")),
              ElementsAre(HasSubstr("body[0].shape' is 0.008 m thick, 0.8 cells")));
}

TEST(SceneWarnings, TellOfTooFewParticles) {
  EXPECT_THAT(warnings(with("per_cell_axis = 2", "per_cell = [2, 1, 2]")), IsEmpty());  // plane strain
  EXPECT_THAT(warnings(with("per_cell_axis = 2", "per_cell = [2, 4, 1]")), IsEmpty());
  EXPECT_THAT(warnings(with("per_cell_axis = 2", "per_cell = [1, 2, 1]")),
              ElementsAre(AllOf(HasSubstr("2 particles a cell"), HasSubstr("plane strain"))));
  const std::string deep = testing::replaced(with("size_m = [0.2, 0.01, 0.1]", "size_m = [0.2, 0.02, 0.1]"),
                                             "per_cell_axis = 2", "per_cell = [2, 1, 2]");
  EXPECT_THAT(warnings(deep), ElementsAre(AllOf(HasSubstr("4 particles a cell"), HasSubstr("3-D"))));
}

TEST(SceneWarnings, TellOfFramesStepsAndMemory) {
  EXPECT_THAT(warnings(with("frame_interval_s = 0.01", "frame_interval_s = 0.001")),
              ElementsAre(AllOf(HasSubstr("shorter than a time step"), HasSubstr("45 steps"))));
  // Without gravity there is no step to be shorter than.
  EXPECT_THAT(
      warnings(testing::replaced(with("frame_interval_s = 0.01", "frame_interval_s = 0.001"),
                                 "gravity_m_s2 = [0.0, 0.0, -9.81]", "gravity_m_s2 = [0.0, 0.0, 0.0]")),
      IsEmpty());
  EXPECT_THAT(warnings(with("frame_interval_s = 0.01", "frame_interval_s = 1.0")),
              ElementsAre(HasSubstr("longer than the run")));
  const std::string day = testing::replaced(with("end_s = 0.045", "end_s = 86400.0"),
                                            "frame_interval_s = 0.01", "frame_interval_s = 1.0");
  EXPECT_THAT(warnings(day), ElementsAre(HasSubstr("e+07 time steps")));
  EXPECT_THAT(warnings(good_scene, 1e6),
              ElementsAre(AllOf(HasSubstr("200 particles"), HasSubstr("1 MB are free"))));
}

TEST(SceneCost, BracketsTheStepsThatAreTaken) {
  const Scene scene = read(testing::replaced(with("end_s = 0.045", "end_s = 0.2"), "frame_interval_s = 0.01",
                                             "frame_interval_s = 0.2"));
  const SceneCost cost = scene_cost(scene);
  State state = initial_state(scene);
  int steps = 0;
  testing::run_for(state, scene.settings, scene.end_time, [&](const State&, const StepReport&) { ++steps; });
  EXPECT_GE(steps, std::floor(cost.fewest_steps));
  EXPECT_LE(steps, std::ceil(cost.most_steps));
  EXPECT_NEAR(cost.particles, 200.0, 1e-6);
}

TEST(SceneCost, CountsWhatSourcesSend) {
  const std::string source =
      "[[source]]\nmaterial = \"sand\"\noutline = \"rectangle\"\nlower_m = [0.1, 0.0, 0.09]\nupper_m = "
      "[0.15, 0.01, "
      "0.09]\nvelocity_m_s = [0.0, 0.0, -0.5]\nend_s = 0.03\n";
  // 5 cells wide, 1.5 high, 8 particles each.
  EXPECT_NEAR(scene_cost(read(good_scene + source)).particles, 200.0 + 5 * 1.5 * 8, 1e-6);
  // For ever: no more than the domain holds.
  const std::string for_ever = testing::replaced(good_scene, "end_s = 0.045", "end_s = 1e6");
  EXPECT_NEAR(
      scene_cost(read(testing::replaced(for_ever, "frame_interval_s = 0.01", "frame_interval_s = 10.0") +
                      testing::replaced(source, "end_s = 0.03\n", "")))
          .particles,
      200.0 + 20 * 10 * 8, 1e-6);
}

TEST(SceneLimits, RefuseWhatTheMachineHasNoMemoryForBeforeItIsMade) {
  const testing::TestFolder folder;
  const auto file = folder.path() / "scene.toml";
  std::ofstream(file) << good_scene;
  EXPECT_THAT(testing::input_error([&] { read_scene(file, {.memory = 1e6}); }),
              AllOf(HasSubstr("domain.cell_size_m"), HasSubstr("this machine has 1 MB")));
  EXPECT_THAT(testing::input_error([&] { read_scene(file, {.particles = 100}); }),
              HasSubstr("at most 1e+02"));
  EXPECT_THAT(testing::input_error([&] { read_scene(file, {.cells = 100}); }), HasSubstr("at most 1e+02"));
  EXPECT_GT(memory_of_machine(), memory_available());
}

}  // namespace
}  // namespace talus
