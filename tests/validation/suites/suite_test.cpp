// Suite files: what is read, and what is refused.
#include "validation/suites/suite.h"

#include <gmock/gmock.h>

#include <fstream>

#include "continuum/files/atomic_file.h"
#include "tests/test_folder.h"
#include "validation/suites/warnings.h"

namespace talus::validation {
namespace {

using ::testing::HasSubstr;
using Seeds = std::vector<std::uint64_t>;

/// The tiny suite with one thing changed and its paths made absolute, in `folder`; returns its path.
std::string tiny_suite_with(const testing::TestFolder& folder, const std::string& from,
                            const std::string& to) {
  const std::filesystem::path source = TALUS_SOURCE_DIR;
  std::string text = read_file(source / "tests/validation/data/tiny_suite.toml");
  text = testing::replaced(text, "../../../dem_cases", (source / "dem_cases").string());
  text = testing::replaced(text, "../../dem_cases", (source / "tests/dem_cases").string());
  const auto file = folder.path() / "suite.toml";
  std::ofstream(file) << testing::replaced(text, from, to);
  return file.string();
}

TEST(SuiteWarnings, TellOfOpeningsGrainsAndMemory) {
  const testing::TestFolder folder;
  const std::string file =
      tiny_suite_with(folder, "tiny_column.toml\"\ncells = 10", "tiny_slot.toml\"\ncells = 4");
  const Suite suite = read_suite(file);
  const auto runs = plan_runs(suite, folder.path());
  EXPECT_THAT(
      suite_warnings(suite, runs, 1e12),
      ::testing::Contains(AllOf(HasSubstr("suite.toml"), HasSubstr("key 'cells' = 4 across the opening"))));
  EXPECT_THAT(suite_warnings(suite, runs, 1e12),
              ::testing::Contains(HasSubstr("grains; figures of fewer than 500")));
  EXPECT_THAT(suite_warnings(suite, runs, 1e12),
              ::testing::Not(::testing::Contains(HasSubstr("needs about"))));
  EXPECT_THAT(suite_warnings(suite, runs, 1e6),
              ::testing::Contains(AllOf(HasSubstr("needs about"), HasSubstr("1 MB are free"))));
  const Suite smoke = read_suite("smoke");
  EXPECT_THAT(suite_warnings(smoke, plan_runs(smoke, folder.path()), 1e12), ::testing::IsEmpty());
}

TEST(Suite, SmokeRunsAllThreeCodesAfreshWithTwoSeedsEach) {
  const Suite suite = read_suite("smoke");
  ASSERT_EQ(suite.points.size(), 1u);
  const SuitePoint& point = suite.points[0];
  EXPECT_EQ(point.name(), "column_collapse/a_1");
  for (const std::string code : {"continuum", "liggghts", "yade"})
    EXPECT_EQ(point.seeds.at(code), (Seeds{1, 2})) << code;
  EXPECT_FALSE(point.stored);
  EXPECT_TRUE(point.refinement);
  EXPECT_THAT(suite_names(), ::testing::IsSupersetOf({"smoke", "reference", "seed", "mutation"}));
}

TEST(Suite, ReferenceIsTheWholeMatrix) {
  const Suite suite = read_suite("reference");
  std::map<std::string, int> points;
  for (const auto& point : suite.points) {
    ++points[point.a_case.name];
    EXPECT_TRUE(point.stored) << point.name();
    EXPECT_TRUE(point.seeds.contains("continuum")) << point.name();
    EXPECT_EQ(point.seeds.at("liggghts"), point.a_case.reference_seeds.at("liggghts")) << point.name();
  }
  const std::map<std::string, int> all{{"column_collapse", 10},
                                       {"cylinder_collapse", 6},
                                       {"slot", 6},
                                       {"hourglass", 4},
                                       {"ledge", 2},
                                       {"heap", 2},
                                       {"impact", 2}};
  EXPECT_EQ(points, all);
}

TEST(Suite, AllThatComeWithTalusAreSound) {
  for (const auto& name : suite_names()) EXPECT_EQ(read_suite(name).name, name);
}

TEST(Suite, ATagSelectsItsPointsAndWhatTheyRequire) {
  const Suite suite = tagged(read_suite("reference"), "discharge");
  for (const auto& point : suite.points)
    EXPECT_THAT(point.a_case.kind, ::testing::AnyOf("slot", "hourglass"));
  EXPECT_EQ(suite.points.size(), 10u);
  EXPECT_THAT(testing::input_error([] { tagged(read_suite("smoke"), "slow"); }),
              HasSubstr("there are: quick"));
  Suite linked = read_suite("reference");
  linked.points[0].tags = {"mine"};
  linked.points[0].required = {"ledge/length_32d"};
  EXPECT_EQ(tagged(linked, "mine").points.size(), 2u);
}

TEST(Suite, RefusesWhatCannotBeMeant) {
  const testing::TestFolder folder;
  const auto error = [&](const std::string& from, const std::string& to) {
    return testing::input_error([&] { read_suite(tiny_suite_with(folder, from, to)); });
  };
  EXPECT_NO_THROW(read_suite(tiny_suite_with(folder, "liggghts_seeds = [1, 2]", "liggghts_seeds = [1, 3]")));
  EXPECT_THAT(testing::input_error([] { read_suite("smok"); }), HasSubstr("did you mean 'smoke'"));
  EXPECT_THAT(testing::input_error([] { read_suite("/nowhere/suite.toml"); }), HasSubstr("no such file"));
  EXPECT_THAT(error("cells = 10", "cells = 10\ncodes = [\"yad\"]"),
              HasSubstr("must hold only: continuum, liggghts, yade"));
  EXPECT_THAT(error("cells = 10", "cells = 10\ncodes = [\"yade\", \"yade\"]"), HasSubstr("must not repeat"));
  EXPECT_THAT(error("liggghts_seeds = [1, 2]", "liggghts_seeds = [1, 1]"), HasSubstr("must not repeat"));
  EXPECT_THAT(error("cells = 10", "cells = 10\npoints = [\"a_7\"]"), HasSubstr("it has: tiny"));
  EXPECT_THAT(error("cells = 10", "cells = 10\nrequires = [\"tiny_column/a_7\"]"),
              HasSubstr("which is no point of this suite"));
  EXPECT_THAT(error("\"no_friction\"", "\"no_fiction\""), HasSubstr("must hold only: no_friction"));
  const std::string twice =
      "[[case]]\nfile = \"" TALUS_SOURCE_DIR
      "/tests/dem_cases/data/tiny_column.toml\"\ncells = 10\ntime_limit_s = 1.0\n[[case]]";
  EXPECT_THAT(error("[[case]]", twice), HasSubstr("'tiny_column/tiny' twice"));
  EXPECT_THAT(error("time_limit_s", "time_limit_min"), HasSubstr("'case[0].time_limit_s': is missing"));
  EXPECT_THAT(error("tiny_column.toml", "absent.toml"), HasSubstr("absent.toml: no such file"));
  EXPECT_THAT(error("schema = 2", "schema = 1"), HasSubstr("schema"));
  for (const std::string name : {"../escaped", "/tmp/escaped", "..", "", "a/b", "$(reboot)"})
    EXPECT_THAT(error("name = \"tiny\"", "name = \"" + name + "\""), HasSubstr("letters, digits")) << name;
}

TEST(Suite, TellsSeveralFaultsAtOnce) {
  const testing::TestFolder folder;
  const auto file = tiny_suite_with(folder, "\"no_friction\"", "\"no_fiction\"");
  write_file_atomically(file, testing::replaced(read_file(file), "cells = 10", "cells = 11"));
  EXPECT_THAT(
      testing::input_error([&] { read_suite(file); }),
      AllOf(HasSubstr("must hold only: no_friction"), HasSubstr("'case[0].cells' = 11: must be even")));
}

}  // namespace
}  // namespace talus::validation
