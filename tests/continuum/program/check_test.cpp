// `talus check` as a user meets it; the same warnings in a run's log; files that try to do harm.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/program.h"

namespace talus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::run_program;

const std::string good_scene = read_file(TALUS_SOURCE_DIR "/tests/continuum/data/small_column.toml");

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

class TalusCheck : public ::testing::Test {
 protected:
  std::string scene(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
    return (folder_.path() / name).string();
  }
  testing::ProgramResult check(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"talus", "check"});
    return run_program(arguments);
  }
  std::string coarse() const {
    return scene("coarse.toml", testing::replaced(good_scene, "per_cell_axis = 2", "per_cell = [1, 2, 1]"));
  }
  const testing::TestFolder folder_;
};

TEST_F(TalusCheck, SaysWhatASoundSceneNeeds) {
  const auto result = check({"--strict", scene("good.toml", good_scene)});
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, AllOf(HasSubstr("20 x 1 x 10 cells, 200 particles"), HasSubstr("MB of memory"),
                                   Not(HasSubstr("warning"))));
}

TEST_F(TalusCheck, TellsAllFaultsOfAllFilesAtOnce) {
  std::string bad = testing::replaced(good_scene, "friction_angle_deg = 30.0", "friction_angle_deg = 300.0");
  bad = testing::replaced(bad, "jitter = 0.5", "jiter = 0.5");
  bad = testing::replaced(bad, "end_s = 0.045", "end_s = nan");
  bad +=
      "[[wall]]\nshape = { kind = \"bax\" }\n[[wall]]\nshape = { kind = \"sphere\", centre_m = [0, 0, 0], "
      "radius_m = -1 }\n";
  const auto result =
      check({scene("bad.toml", bad), scene("other.toml", "schema = 7\n"), scene("good.toml", good_scene)});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, AllOf(HasSubstr("bad.toml:15: key 'material[0].friction_angle_deg' = 300"),
                                   HasSubstr("between 0 and 60"), HasSubstr("the file has 'jiter' instead"),
                                   HasSubstr("'time.end_s' = nan"), HasSubstr("'wall[0].shape.kind' = 'bax'"),
                                   HasSubstr("'wall[1].shape.radius_m' = -1")));
  EXPECT_THAT(result.output,
              AllOf(HasSubstr("other.toml:1"), HasSubstr("200 particles"), HasSubstr("2 of 3 scenes")));
}

TEST_F(TalusCheck, WarningsFailOnlyWhenStrict) {
  const auto lenient = check({coarse()}), strict = check({"--strict", coarse()});
  EXPECT_EQ(lenient.exit_code, 0);
  EXPECT_EQ(strict.exit_code, 2);
  for (const auto& result : {lenient, strict})
    EXPECT_THAT(result.output, AllOf(HasSubstr("warning: "), HasSubstr("2 particles a cell")));
}

TEST_F(TalusCheck, ARunTellsTheSameWarnings) {
  const auto result = run_program({"talus", "run", coarse(), "-o", (folder_.path() / "out").string()});
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("2 particles a cell"));
}

TEST_F(TalusCheck, FindsSandThatOverlaps) {
  const auto result = check(
      {scene("twice.toml", good_scene + "[[sand]]\nmaterial = \"sand\"\nshape = { kind = \"box\", lower_m = "
                                        "[0.0, 0.0, 0.0], upper_m = [0.05, 0.01, 0.05] }\n")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("overlap"));
}

TEST_F(TalusCheck, MemoryOfWhatItIsSaidToNeed) {
  if (sanitized) GTEST_SKIP() << "a sanitizer's own memory is beyond what this measures";
  const std::string cylinder = TALUS_SOURCE_DIR "/continuum/scenes/bench/cylinder_13k.toml";
  const auto json = (folder_.path() / "cost.json").string();
  ASSERT_EQ(run_program({"talus", "bench", "--frames", "2", "--json", json, cylinder}).exit_code, 0);
  const double peak = nlohmann::json::parse(read_file(json)).at("peak_mb").get<double>();
  const std::string told = check({cylinder}).output;
  const double expected = std::stod(told.substr(told.find("; about ") + 8));
  EXPECT_GE(expected, 0.9 * peak);
  EXPECT_LE(expected, 2.0 * peak);
}

/// A body's name names a file: it must not lead out of the output folder, nor may anything else that a scene says.
TEST_F(TalusCheck, ASceneWritesNothingOutsideItsOutput) {
  const auto body = [](const std::string& name) {
    return "[[body]]\nname = \"" + name +
           "\"\nshape = { kind = 'sphere', centre_m = [0.1, 0.005, 0.06], radius_m = 0.005 }\ndensity_kg_m3 "
           "= "
           "7800.0\nfriction_angle_deg = 20.0\n";
  };
  for (const std::string name :
       {"../escaped", "/tmp/escaped", "a/b", "..", ".", "", "a\\nb", "a b", "$(touch escaped)", "a;b"}) {
    const auto result = run_program({"talus", "run", scene("hostile.toml", good_scene + body(name)), "-o",
                                     (folder_.path() / "out").string()});
    EXPECT_EQ(result.exit_code, 2) << name;
    EXPECT_THAT(result.output, HasSubstr("must be letters, digits")) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "escaped.stl"));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out" / "bodies"));
}

TEST_F(TalusCheck, AMeshIsOnlyRead) {
  const std::string passwords =
      "[[wall]]\nrough = true\nshape = { kind = \"mesh\", file = \"../../../../../../../../etc/passwd\" }\n";
  const auto result = check({scene("mesh.toml", good_scene + passwords)});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, AllOf(HasSubstr("give an .stl or .obj file"), Not(HasSubstr("root:"))));
}

TEST_F(TalusCheck, HugeSizesAreRefusedBeforeAnythingIsMade) {
  if (sanitized) GTEST_SKIP() << "a sanitizer's own memory is beyond what this measures";
  const auto refused = [&](const std::string& from, const std::string& to, const char* why) {
    // A hundred megabytes of address space is more than reading takes, and far less than what is asked for.
    const auto result = run_program({"/bin/sh", "-c",
                                     "ulimit -v 400000; exec '" TALUS_BINARY_DIR "/bin/talus' check '" +
                                         scene("huge.toml", testing::replaced(good_scene, from, to)) + "'"},
                                    20.0);
    EXPECT_EQ(result.exit_code, 2) << result.output;
    EXPECT_THAT(result.output, HasSubstr(why));
  };
  refused("size_m = [0.2, 0.01, 0.1]", "size_m = [2000.0, 2000.0, 2000.0]", "at most 5e+07");
  refused("size_m = [0.2, 0.01, 0.1]", "size_m = [1e300, 1e300, 1e300]", "between 1e-09 and 1000000");
  refused("cell_size_m = 0.01", "cell_size_m = 1e-6", "at most 5e+07");
  refused("per_cell_axis = 2", "per_cell_axis = 2000000000", "between 2 and 8");
  refused("end_s = 0.045", "end_s = 1e9", "frames");
}

}  // namespace
}  // namespace talus
