// What `talus-dem check` tells of case files, and what a hostile one cannot do to folders and decks.
#include "dem_cases/check.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "dem_cases/liggghts/liggghts.h"
#include "dem_cases/reference/plan.h"
#include "dem_cases/yade/yade.h"
#include "tests/dem_cases/case_files.h"

namespace talus::dem {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::string column = read_file(tiny_column_file);
const std::string slot = read_file(TALUS_SOURCE_DIR "/tests/dem_cases/data/tiny_slot.toml");

class CaseChecks : public ::testing::Test {
 protected:
  std::filesystem::path file(const std::string& text) const {
    write_file_atomically(folder_.path() / "case.toml", text);
    return folder_.path() / "case.toml";
  }
  CaseCheck check(const std::string& text) const { return check_case_file(file(text)); }
  const TestFolder folder_;
};

TEST_F(CaseChecks, FindNothingWrongWithTheCasesThatComeWithTalus) {
  for (const auto& case_file : gravity_case_files()) {
    const CaseCheck found = check_case_file(case_file);
    EXPECT_THAT(found.faults, IsEmpty()) << case_file;
    EXPECT_EQ(found.needs.size(), read_case_points(case_file).size());
  }
  EXPECT_THAT(check_case_file(shear_cell_file()).faults, IsEmpty());
  EXPECT_THAT(check_case_file(column_collapse_file).warnings, IsEmpty());
}

TEST_F(CaseChecks, TellAllFaultsAtOnce) {
  std::string bad = replaced(column, "wall_friction = 0.0", "wall_friction = 7.0");
  bad = replaced(bad, "volume_fraction", "volume_fracton");
  bad = replaced(bad, "diameter_spread = 0.15", "diameter_spread = inf");
  EXPECT_THAT(check(bad).faults, ElementsAre(HasSubstr("diameter_spread' = inf"),
                                             HasSubstr("the file has 'volume_fracton' instead"),
                                             HasSubstr("contact.wall_friction")));
  EXPECT_THAT(check("kind = 3").faults, ElementsAre(HasSubstr("case.toml:1: key 'kind' = 3")));
  EXPECT_THAT(check_case_file("/nowhere/case.toml").faults, ElementsAre(HasSubstr("no such file")));
}

TEST_F(CaseChecks, HoldTheTimeStepToItsLimits) {
  EXPECT_THAT(check(replaced(column, "time_step_s = ", "time_step_s = 10.0 # ")).faults,
              ElementsAre(HasSubstr("time_step_s")));
  const CaseCheck found = check(column);
  EXPECT_THAT(found.faults, IsEmpty());
  EXPECT_THAT(found.needs, ElementsAre(AllOf(HasSubstr("point tiny"), HasSubstr("of the Rayleigh time"))));
}

constexpr double plenty = 1e15;  // bytes

TEST_F(CaseChecks, WarnOfMoreMemoryThanIsFree) {
  const Case a_case = read_case(file(column));
  const double needed = expected_memory(a_case);
  EXPECT_NEAR(needed, 200e6 + 10e3 * expected_grains(a_case), 1.0);
  EXPECT_THAT(case_warnings(a_case, needed), Not(::testing::Contains(HasSubstr("are free"))));
  EXPECT_THAT(case_warnings(a_case, 0.5 * needed),
              ::testing::Contains(AllOf(HasSubstr("grains.diameter_m"), HasSubstr("which need about"))));
}

TEST_F(CaseChecks, WarnOfFewGrainsAndNarrowOpenings) {
  EXPECT_THAT(check(column).warnings,
              ElementsAre(AllOf(HasSubstr("grains.diameter_m"), HasSubstr("fewer than 500"))));
  Case narrow = read_case(file(slot));
  auto& geometry = std::get<SlotGeometry>(narrow.geometry);
  const double d = narrow.grains.diameter;
  geometry.opening = 6.0 * d;
  EXPECT_THAT(case_warnings(narrow, plenty), Not(::testing::Contains(HasSubstr("opening_m"))));
  geometry.opening = 4.0 * d;
  EXPECT_THAT(case_warnings(narrow, plenty),
              ::testing::Contains(AllOf(HasSubstr("geometry.opening_m"), HasSubstr("4 grain diameters"))));
  narrow.geometry = HourglassGeometry{2.5 * d, 8.0 * d, 6.0 * d, 10.0 * d, 20.0 * d};
  EXPECT_THAT(case_warnings(narrow, plenty),
              ::testing::Contains(AllOf(HasSubstr("throat_radius_m"), HasSubstr("5 grain diameters"))));
}

/// Names that would leave a folder, end a line of a deck, or start a command of a shell, of LIGGGHTS or of Python.
const std::vector<std::string> hostile_names{"../escaped",
                                             "/tmp/escaped",
                                             "..",
                                             ".hidden",
                                             "",
                                             "a/b",
                                             R"(x\nshell touch escaped)",
                                             "a b",
                                             "x; reboot",
                                             "$(reboot)",
                                             "`reboot`",
                                             "${now}",
                                             R"(\"\"\")",
                                             R"(x\ry)",
                                             "x#y",
                                             "x&y",
                                             "x'y",
                                             "naïve",
                                             R"(x\u0000y)",
                                             "*",
                                             "-in\\n"};

TEST_F(CaseChecks, NamesThatWouldBeCommandsOrPathsAreRefused) {
  for (const std::string& name : hostile_names) {
    for (const std::string key : {"name", "base_point", "material"}) {
      const std::string own = key == "name"         ? "name = \"tiny_column\""
                              : key == "base_point" ? "base_point = \"tiny\""
                                                    : "material = \"rolling_friction_0_2\"";
      EXPECT_THAT(input_error([&] { read_case(file(replaced(column, own, key + " = \"" + name + "\""))); }),
                  AllOf(HasSubstr("key '" + key + "'"), HasSubstr("letters, digits")))
          << key << " = " << name;
    }
    EXPECT_THAT(
        input_error([&] { read_case_points(file(column + "\n[[point]]\nname = \"" + name + "\"\n")); }),
        HasSubstr("letters, digits"))
        << name;
  }
}

/// What may be any text, the title and the reasons of bands, reaches no deck, data file or script.
TEST_F(CaseChecks, FreeTextReachesNoCode) {
  std::string text = column;
  const auto put = [&](const std::string& key) {
    const auto at = text.find(key + " = \"") + key.size() + 4;
    text.insert(at, R"(\nshell touch MARKED\nimport os; os.system('MARKED') \"\"\" ${MARKED} )");
  };
  put("title");
  put("why");
  const Case a_case = read_case(file(text));
  ASSERT_THAT(a_case.title, HasSubstr("MARKED"));
  const Packing packing = make_packing(a_case, 1);
  liggghts::write_input(a_case, packing, folder_.path() / "liggghts");
  yade::write_input(a_case, packing, folder_.path() / "yade");
  int files = 0;
  for (const char* code : {"liggghts", "yade"}) {
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / code)) {
      EXPECT_THAT(read_file(entry.path()), Not(HasSubstr("MARKED"))) << entry.path();
      ++files;
    }
  }
  EXPECT_GE(files, 5);
}

TEST_F(CaseChecks, HugeSizesAreRefusedBeforeAnythingIsMade) {
  EXPECT_THAT(
      input_error([&] { read_case(file(replaced(column, "tank_length_m = ", "tank_length_m = 1e300 # "))); }),
      HasSubstr("at most 100"));
  EXPECT_THAT(
      input_error([&] { read_case(file(replaced(column, "diameter_m = ", "diameter_m = 1e-9 # "))); }),
      HasSubstr("grains"));
}

}  // namespace
}  // namespace talus::dem
