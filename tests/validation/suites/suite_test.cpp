// Suite files: what is read, and what is refused.
#include "validation/suites/suite.h"

#include <gmock/gmock.h>

#include <fstream>

#include "continuum/scene/checked_table.h"
#include "tests/program.h"

namespace talus::validation {
namespace {

using ::testing::HasSubstr;

std::string tiny_suite_with(const std::string& from, const std::string& to) {
  std::string text =
      read_file(std::filesystem::path(TALUS_SOURCE_DIR) / "tests/validation/data/tiny_suite.toml");
  for (const std::string relative : {"../../../dem_cases", "../../dem_cases"}) {
    const auto at = text.find(relative);
    const std::string base = relative.size() > 16 ? "/dem_cases" : "/tests/dem_cases";
    text.replace(at, relative.size(), TALUS_SOURCE_DIR + base);
  }
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  const auto file = testing::fresh_folder("suite") / "suite.toml";
  std::ofstream(file) << text;
  return file.string();
}

std::string error_of(const std::string& suite) {
  try {
    read_suite(suite);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Suite, SmokeRunsAllThreeCodesWithTwoSeedsEach) {
  const Suite suite = read_suite("smoke");
  ASSERT_EQ(suite.cases.size(), 1u);
  EXPECT_EQ(suite.cases[0].backends, (std::vector<std::string>{"continuum", "liggghts", "yade"}));
  EXPECT_EQ(suite.cases[0].seeds.size(), 2u);
  EXPECT_EQ(suite.cases[0].column.name, "column_collapse");
  EXPECT_THAT(suite_names(), ::testing::Contains("smoke"));
}

TEST(Suite, RefusesWhatCannotBeMeant) {
  EXPECT_EQ(error_of(tiny_suite_with("seeds = [1, 2]", "seeds = [1, 3]")), "no error");
  EXPECT_THAT(error_of("smok"), HasSubstr("did you mean 'smoke'"));
  EXPECT_THAT(error_of("/nowhere/suite.toml"), HasSubstr("no such file"));
  EXPECT_THAT(error_of(tiny_suite_with("\"yade\"]", "\"yad\"]")),
              HasSubstr("must hold only: continuum, liggghts, yade"));
  EXPECT_THAT(error_of(tiny_suite_with("\"yade\"]", "\"liggghts\"]")), HasSubstr("must not repeat"));
  EXPECT_THAT(error_of(tiny_suite_with("seeds = [1, 2]", "seeds = [1, 1]")), HasSubstr("must not repeat"));
  EXPECT_THAT(error_of(tiny_suite_with("yade = 5.0", "")), HasSubstr("expected_cpu_s.yade"));
  EXPECT_THAT(error_of(tiny_suite_with("time_limit_s", "time_limit_min")),
              HasSubstr("'case[0].time_limit_s': is missing"));
  EXPECT_THAT(error_of(tiny_suite_with("tiny_column.toml", "absent.toml")),
              HasSubstr("absent.toml: no such file"));
}

}  // namespace
}  // namespace talus::validation
