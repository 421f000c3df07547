// Bad input gets one clear error: file, line, key, value, what is allowed, the nearest right name.
#include "continuum/files/checked_table.h"

#include <gmock/gmock.h>

#include <array>
#include <fstream>

#include "tests/test_folder.h"

namespace talus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class CheckedTableTest : public ::testing::Test {
 protected:
  CheckedTable parse(const std::string& text) {
    file_ = folder_.path() / "checked_table.toml";
    std::ofstream(file_) << text;
    return CheckedTable::parse_file(file_);
  }
  testing::TestFolder folder_;
  std::filesystem::path file_;
};

TEST_F(CheckedTableTest, ReadsWhatIsThere) {
  const auto table = parse("a = 1\nb = 2.5\nc = 'x'\nd = [1, 2.0, 3]\n[t]\nn = [4, 5]\n");
  EXPECT_EQ(table.number("a"), 1.0);
  EXPECT_EQ(table.number("b", positive), 2.5);
  EXPECT_EQ(table.string("c"), "x");
  EXPECT_EQ(table.vector("d"), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(table.table("t").integers("n", 0, 9), (std::vector<std::int64_t>{4, 5}));
  EXPECT_EQ(table.number("absent", {}, 7.0), 7.0);
  EXPECT_NO_THROW(table.finish());
}

TEST_F(CheckedTableTest, RefusesWhatIsNoTextAndWhatIsHuge) {
  EXPECT_THAT(testing::input_error([&] { parse("a = 1\n[\x01]\n"); }),
              AllOf(HasSubstr("checked_table.toml:2"), HasSubstr("control character 0x01")));
  EXPECT_THAT(testing::input_error([&] { parse(std::string("a = '\0'\n", 8)); }), HasSubstr("0x00"));
  EXPECT_NO_THROW(parse("a = 1\t# tab\r\n"));
  std::ofstream(file_) << "a = 1\n";
  std::filesystem::resize_file(file_, 5'000'000'000);  // a hole, which takes no disk
  EXPECT_THAT(testing::input_error([&] { CheckedTable::parse_file(file_); }),
              HasSubstr("has 5000 MB; at most 10"));
  // Nothing that a few bytes can ask for takes long or much.
  EXPECT_THAT(testing::input_error([&] { parse("a = " + std::string(100'000, '[')); }),
              HasSubstr("not valid TOML"));
}

TEST_F(CheckedTableTest, RefusesKeysOfAHundredThousandPartsAndNoOtherDots) {
  std::string key = "a";
  for (int part = 0; part < 100'000; ++part) key += ".a";
  for (const std::string& text : {"x = 1\n" + key + " = 1\n", "x = 1\n[" + key + "]\n",
                                  "x = 1\ny = {" + key + " = 1}\n", "x = 1\n" + key + " = \n"}) {
    EXPECT_THAT(testing::input_error([&] { parse(text); }),
                AllOf(HasSubstr("checked_table.toml:2"), HasSubstr("a key of more than 32 parts")));
  }
  const std::string dots(100, '.');
  EXPECT_NO_THROW(parse("# " + dots + "\na = \"\\\"" + dots + "\"\nb = '" + dots + "'\nc = \"\"\"\n\"" +
                        dots + "\"\"\"\nd = [" + "1.0, 1.0,\n1.5e3]\n"));
}

TEST_F(CheckedTableTest, AWrongChoiceNamesTheNearestRightOne) {
  constexpr std::array<std::string_view, 2> kinds{"box", "sphere"};
  EXPECT_THAT(testing::input_error([&] { parse("kind = \"bax\"\n").choice("kind", kinds); }),
              AllOf(HasSubstr("must be one of: box, sphere"), HasSubstr("did you mean 'box'?")));
}

TEST_F(CheckedTableTest, UnknownKeyNamesTheNearestRightOne) {
  const auto table = parse("\ndiameter_mm = 3.0\n");
  table.has("diameter_m");
  table.has("density_kg_m3");
  EXPECT_THAT(testing::input_error([&] { table.finish(); }),
              AllOf(HasSubstr("checked_table.toml:2"), HasSubstr("'diameter_mm' = 3"),
                    HasSubstr("did you mean 'diameter_m'"), HasSubstr("density_kg_m3")));
}

TEST_F(CheckedTableTest, AMissingKeyNamesTheOneThatMayHaveBeenMeant) {
  const auto table = parse("diameter_mm = 3.0\n");
  EXPECT_THAT(
      testing::input_error([&] { table.number("diameter_m", positive); }),
      AllOf(HasSubstr("'diameter_m'"), HasSubstr("is missing"), HasSubstr("has 'diameter_mm' instead")));
  EXPECT_THAT(testing::input_error([&] { table.number("density_kg_m3"); }), Not(HasSubstr("instead")));
}

TEST_F(CheckedTableTest, OutOfRangeNamesValueAndRange) {
  const auto table = parse("[grains]\nd = -1.0\n");
  EXPECT_THAT(testing::input_error([&] { table.table("grains").number("d", positive); }),
              AllOf(HasSubstr(":2"), HasSubstr("'grains.d' = -1"), HasSubstr("greater than 0")));
}

TEST_F(CheckedTableTest, NotFiniteIsOutOfEveryRange) {
  const auto table = parse("a = nan\nb = inf\n");
  EXPECT_THAT(testing::input_error([&] { table.number("a"); }), HasSubstr("any finite number"));
  EXPECT_THAT(testing::input_error([&] { table.number("b"); }), HasSubstr("any finite number"));
}

TEST_F(CheckedTableTest, WrongTypesAreErrors) {
  const auto table = parse("a = '3 mm'\nb = 1.5\nc = [1, 1]\nd = true\n");
  EXPECT_THAT(testing::input_error([&] { table.number("a"); }),
              AllOf(HasSubstr("'3 mm'"), HasSubstr("must be a number")));
  EXPECT_THAT(testing::input_error([&] { table.integer("b", 0, 9); }),
              HasSubstr("whole number between 0 and 9"));
  EXPECT_THAT(testing::input_error([&] { table.integers("c", 0, 9); }), HasSubstr("must not repeat"));
  EXPECT_THAT(testing::input_error([&] { table.number("d"); }), HasSubstr("must be a number"));
  EXPECT_THAT(testing::input_error([&] { table.table("a"); }), HasSubstr("must be a table"));
}

TEST_F(CheckedTableTest, ReadsPairsAndRefusesOthers) {
  const auto table =
      parse("a = [[1, 2.5], [3, -4]]\nb = [[1, 2, 3]]\nc = [1, 2]\nd = []\ne = [[1, 'x']]\nf = [[1, nan]]\n");
  EXPECT_EQ(table.pairs("a"), (std::vector<Eigen::Vector2d>{{1, 2.5}, {3, -4}}));
  EXPECT_NO_THROW(table.pairs("a", non_negative));
  EXPECT_THAT(testing::input_error([&] {
                table.pairs("a", {2.0, 9.0});
              }),
              AllOf(HasSubstr("checked_table.toml:1"),
                    HasSubstr("first number of each pair must be between 2 and 9")));
  EXPECT_THAT(testing::input_error([&] { table.pairs("a", {}, non_negative); }),
              HasSubstr("second number of each pair must be at least 0"));
  EXPECT_THAT(testing::input_error([&] { table.pairs("b"); }), HasSubstr("must be a pair of numbers"));
  EXPECT_THAT(testing::input_error([&] { table.pairs("c"); }), HasSubstr("must be a pair of numbers"));
  EXPECT_THAT(testing::input_error([&] { table.pairs("d"); }), HasSubstr("list of pairs"));
  EXPECT_THAT(testing::input_error([&] { table.pairs("e"); }), HasSubstr("each entry must be a number"));
  EXPECT_THAT(testing::input_error([&] { table.pairs("f"); }), HasSubstr("any finite number"));
  EXPECT_THAT(testing::input_error([&] { table.pairs("g"); }), HasSubstr("is missing"));
}

TEST_F(CheckedTableTest, ReadsTrueAndFalseAndNothingElse) {
  const auto table = parse("a = true\nb = 1\n");
  EXPECT_TRUE(table.boolean("a", false));
  EXPECT_TRUE(table.boolean("absent", true));
  EXPECT_THAT(testing::input_error([&] { table.boolean("b", false); }), HasSubstr("must be true or false"));
}

TEST_F(CheckedTableTest, MissingKeysAndTablesAreErrors) {
  const auto table = parse("schema = 2\n");
  EXPECT_THAT(testing::input_error([&] { table.number("h"); }),
              AllOf(HasSubstr("'h'"), HasSubstr("is missing")));
  EXPECT_THAT(testing::input_error([&] { table.table("grains"); }), HasSubstr("needs a table [grains]"));
  EXPECT_THAT(testing::input_error([&] { table.tables("box"); }), HasSubstr("at least one [[box]]"));
  EXPECT_THAT(testing::input_error([&] { table.require_schema(1); }), HasSubstr("reads schema 1"));
}

TEST_F(CheckedTableTest, HalfAFileAndNoFileAreErrors) {
  EXPECT_THAT(testing::input_error([&] { parse("a = 1\n[geome"); }),
              AllOf(HasSubstr("checked_table.toml:2"), HasSubstr("not valid TOML")));
  EXPECT_THAT(testing::input_error([] { CheckedTable::parse_file("/nowhere/x.toml"); }),
              AllOf(HasSubstr("/nowhere/x.toml"), HasSubstr("no such file")));
}

TEST(NearestName, FindsTyposAndLeavesStrangersAlone) {
  const std::set<std::string> names{"friction", "restitution", "density_kg_m3"};
  EXPECT_EQ(nearest_name("fricton", names), "friction");
  EXPECT_EQ(nearest_name("density", names), std::nullopt);
  EXPECT_EQ(nearest_name("colour", names), std::nullopt);
}

}  // namespace
}  // namespace talus
