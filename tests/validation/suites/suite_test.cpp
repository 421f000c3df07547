// Suite files: what is read, and what is refused.
#include "validation/suites/suite.h"

#include <gmock/gmock.h>

#include <fstream>

#include "continuum/files/atomic_file.h"
#include "tests/test_folder.h"

namespace talus::validation {
namespace {

using ::testing::HasSubstr;

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

TEST(Suite, SmokeRunsAllThreeCodesWithTwoSeedsEach) {
  const Suite suite = read_suite("smoke");
  ASSERT_EQ(suite.cases.size(), 1u);
  EXPECT_EQ(suite.cases[0].backends, (std::vector<std::string>{"continuum", "liggghts", "yade"}));
  EXPECT_EQ(suite.cases[0].seeds.size(), 2u);
  EXPECT_EQ(suite.cases[0].column.name, "column_collapse");
  EXPECT_THAT(suite_names(), ::testing::Contains("smoke"));
}

TEST(Suite, RefusesWhatCannotBeMeant) {
  const testing::TestFolder folder;
  const auto error = [&](const std::string& from, const std::string& to) {
    return testing::input_error([&] { read_suite(tiny_suite_with(folder, from, to)); });
  };
  EXPECT_NO_THROW(read_suite(tiny_suite_with(folder, "seeds = [1, 2]", "seeds = [1, 3]")));
  EXPECT_THAT(testing::input_error([] { read_suite("smok"); }), HasSubstr("did you mean 'smoke'"));
  EXPECT_THAT(testing::input_error([] { read_suite("/nowhere/suite.toml"); }), HasSubstr("no such file"));
  EXPECT_THAT(error("\"yade\"]", "\"yad\"]"), HasSubstr("must hold only: continuum, liggghts, yade"));
  EXPECT_THAT(error("\"yade\"]", "\"liggghts\"]"), HasSubstr("must not repeat"));
  EXPECT_THAT(error("seeds = [1, 2]", "seeds = [1, 1]"), HasSubstr("must not repeat"));
  EXPECT_EQ(read_suite(tiny_suite_with(folder, "seeds = [1, 2]", "")).cases[0].seeds.size(), 3u);
  const std::string twice = "[[case]]\nfile = \"" TALUS_SOURCE_DIR
                            "/tests/dem_cases/data/tiny_column.toml\"\nbackends = "
                            "[\"yade\"]\ntime_limit_s = 1.0\nexpected_cpu_s.yade = 1.0\n[[case]]";
  EXPECT_THAT(error("[[case]]", twice), HasSubstr("second case named 'tiny_column'"));
  EXPECT_THAT(error("yade = 5.0", ""), HasSubstr("expected_cpu_s.yade"));
  EXPECT_THAT(error("time_limit_s", "time_limit_min"), HasSubstr("'case[0].time_limit_s': is missing"));
  EXPECT_THAT(error("tiny_column.toml", "absent.toml"), HasSubstr("absent.toml: no such file"));
}

}  // namespace
}  // namespace talus::validation
