#include "dem_cases/case.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>

#include "dem_cases/reference/plan.h"
#include "dem_cases/time_step.h"
#include "tests/dem_cases/case_files.h"

namespace talus::dem {
namespace {

using ::testing::HasSubstr;

TEST(Case, ReadsTheColumnCollapse) {
  const Case column = read_case(column_collapse_file);
  EXPECT_EQ(column.name, "column_collapse");
  EXPECT_EQ(column.calibration, "rolling_friction_0_2");
  EXPECT_DOUBLE_EQ(column_geometry(column).column_length, 16 * 0.003);
  EXPECT_DOUBLE_EQ(column_geometry(column).column_height, 16 * 0.003);
  EXPECT_DOUBLE_EQ(column_geometry(column).thickness, 4 * 0.003);
  EXPECT_TRUE(column_geometry(column).rough_floor);
  EXPECT_DOUBLE_EQ(column.grains.youngs_modulus, 5e6);
  EXPECT_DOUBLE_EQ(column.contact.rolling_friction, 0.2);
  EXPECT_DOUBLE_EQ(column.contact.wall_friction, 0.0);
  EXPECT_DOUBLE_EQ(column.protocol.time_step, 3.5e-5);
  EXPECT_EQ(column.seeds, (std::vector<std::uint64_t>{1, 2, 3}));
  ASSERT_EQ(column.observables.size(), 6U);
  for (const auto& band : column.observables) EXPECT_FALSE(band.why.empty()) << band.name;
  EXPECT_EQ(column.input_hash.size(), 64U);
}

TEST(Case, PointsLieOverTheFilesOwnKeys) {
  const auto points = read_case_points(column_collapse_file);
  ASSERT_GT(points.size(), 8U);
  EXPECT_EQ(points.front().point, "a_1");
  const Case tall = read_case(column_collapse_file, "a_2");
  EXPECT_EQ(tall.point, "a_2");
  EXPECT_DOUBLE_EQ(column_geometry(tall).column_height, 32 * 0.003);
  EXPECT_DOUBLE_EQ(column_geometry(tall).column_length, 16 * 0.003);  // the file's own
  const Case slippery = read_case(column_collapse_file, "a_1_rolling_0");
  EXPECT_EQ(slippery.contact.rolling_friction, 0.0);
  EXPECT_EQ(slippery.calibration, "rolling_friction_0");
}

TEST(Case, UnknownPointNamesThoseThereAre) {
  EXPECT_THAT(input_error([] { read_case(column_collapse_file, "a_3"); }),
              ::testing::AllOf(HasSubstr("a_3"), HasSubstr("a_2"), HasSubstr("case.toml")));
}

TEST(Case, MistakeInAPointIsToldWithItsLine) {
  const TestFolder folder;
  const auto file = folder.path() / "mistaken.toml";
  const auto text = replaced(read_file(column_collapse_file), "geometry.tank_length_m = 0.384",
                             "geometry.tank_lenth_m = 0.384");
  const auto line =
      1 + std::count(text.begin(), text.begin() + static_cast<long>(text.find("tank_lenth_m")), '\n');
  write_file_atomically(file, text);
  EXPECT_THAT(input_error([&] { read_case(file, "a_2"); }),
              ::testing::AllOf(HasSubstr(fmt::format("{}:{}: key ", file.string(), line)),
                               HasSubstr("tank_length_m")));
}

TEST(Case, EveryCaseThatComesWithTalusIsGood) {
  for (const auto& file : gravity_case_files()) {
    for (const Case& point : read_case_points(file)) {
      EXPECT_NO_THROW(check_time_step(point)) << point.name << " " << point.point;
      EXPECT_FALSE(point.reference_seeds.empty()) << point.name << " " << point.point;
    }
  }
}

TEST(Case, AnImpactIsFasterThanTheFallToTheBed) {
  const TestFolder folder;
  const auto file = folder.path() / "slow.toml";
  const auto text = read_file(TALUS_SOURCE_DIR "/tests/dem_cases/data/tiny_impact.toml");
  write_file_atomically(file, replaced(text, "impact_speed_m_s = 0.7", "impact_speed_m_s = 0.39"));
  EXPECT_THAT(input_error([&] { read_case(file); }),
              ::testing::AllOf(HasSubstr("slow.toml:19: key 'geometry.impact_speed_m_s' = 0.39"),
                               HasSubstr("more than 0.3962")));
  write_file_atomically(file, replaced(text, "side_m = 0.04", "side_m = 0.019"));
  EXPECT_THAT(input_error([&] { read_case(file); }), HasSubstr("geometry.side_m"));
}

struct Mistake {
  const char* name;
  const char* from;
  const char* to;
  const char* line_of;  // what stands, in the good file, on the line that the message names
  std::vector<const char*> said;
};

void PrintTo(const Mistake& mistake, std::ostream* out) { *out << mistake.name; }

class MistakenCase : public ::testing::TestWithParam<Mistake> {};

TEST_P(MistakenCase, IsOneClearError) {
  const TestFolder folder;
  const auto file = folder.path() / "mistaken.toml";
  const auto good = read_file(column_collapse_file);
  const auto place = good.find(GetParam().line_of);
  ASSERT_NE(place, std::string::npos);
  const auto line = 1 + std::count(good.begin(), good.begin() + static_cast<long>(place), '\n');
  write_file_atomically(file, replaced(good, GetParam().from, GetParam().to));
  const std::string message = input_error([&] { read_case(file); });
  EXPECT_THAT(message, HasSubstr(fmt::format("{}:{}: key ", file.string(), line)));
  for (const char* part : GetParam().said) EXPECT_THAT(message, HasSubstr(part));
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, MistakenCase,
    ::testing::Values(
        Mistake{"unknown_key",
                "diameter_spread = 0.15",
                "diameter_spraed = 0.15",
                "[grains]",
                {"diameter_spread"}},
        Mistake{"extra_key",
                "wall_friction = 0.0",
                "wal_friction = 1.0 #\nwall_friction = 0.0",
                "wall_friction",
                {"wal_friction", "did you mean 'wall_friction'"}},
        Mistake{"wrong_unit", "diameter_m = 0.003", "diameter_mm = 3.0", "[grains]", {"diameter_m"}},
        Mistake{"missing_key",
                "density_kg_m3 = 2500.0",
                "",
                "[grains]",
                {"grains.density_kg_m3", "is missing", "between 100"}},
        Mistake{"out_of_range",
                "poissons_ratio = 0.3",
                "poissons_ratio = 0.75",
                "poissons_ratio",
                {"grains.poissons_ratio", "0.75", "0.49"}},
        Mistake{"not_a_number",
                "gravity_m_s2 = 9.81",
                "gravity_m_s2 = \"9.81\"",
                "gravity_m_s2",
                {"protocol.gravity_m_s2", "number"}},
        Mistake{"other_schema", "schema = 1", "schema = 2", "schema = 1", {"schema", "2", "1"}},
        Mistake{"tank_too_short",
                "tank_length_m = 0.24 ",
                "tank_length_m = 0.05 ",
                "tank_length_m",
                {"geometry.tank_length_m", "0.05", "0.054"}},
        Mistake{"too_thin",
                "thickness_m = 0.012",
                "thickness_m = 0.006",
                "thickness_m",
                {"geometry.thickness_m", "0.006", "0.009"}},
        Mistake{"unknown_floor",
                "floor = \"rough\"",
                "floor = \"icy\"",
                "floor = ",
                {"geometry.floor", "icy", "rough, flat"}},
        Mistake{"unknown_observable",
                "name = \"x95\"",
                "name = \"x99\"",
                "name = \"x95\"",
                {"observable[1].name", "x99", "x95"}},
        Mistake{"repeated_observable",
                "name = \"x95\"",
                "name = \"x90\"",
                "name = \"x95\"",
                {"observable[1].name", "twice"}},
        Mistake{"steps_not_whole",
                "run_time_s = 0.7",
                "run_time_s = 0.71875",
                "run_time_s",
                {"protocol.run_time_s", "0.71875", "0.714 and 0.721"}},
        Mistake{
            "repeated_seed", "\nseeds = [1, 2, 3]", "\nseeds = [1, 2, 2]", "seeds = ", {"seeds", "repeat"}},
        Mistake{"name_of_no_folder",
                "name = \"column_collapse\"",
                "name = \"../collapse\"",
                "name = \"column_collapse\"",
                {"name", "../collapse", "letters"}}),
    [](const auto& instance) { return instance.param.name; });

TEST(Case, HalfAFileIsAnErrorWhereverItIsCut) {
  const TestFolder folder;
  const auto file = folder.path() / "half.toml";
  const std::string whole = read_file(column_collapse_file);
  const auto last_key = whole.rfind("why = ");
  for (std::size_t size = 0; size < last_key; size += 97) {
    write_file_atomically(file, whole.substr(0, size));
    // A cut between two [[observable]] tables leaves a whole, shorter case; nothing can tell.
    const auto kept = whole.substr(0, size);
    const auto text_end = kept.find_last_not_of(" \n");
    const bool between = kept.find("[[observable]]") != std::string::npos && text_end != std::string::npos &&
                         kept[text_end] == '"' && kept.rfind("why = ") > kept.rfind("[[observable]]");
    if (between) continue;
    EXPECT_THAT(input_error([&] { read_case(file); }), HasSubstr("half.toml")) << "cut at " << size;
  }
}

TEST(Case, ThereIsNoSuchFile) {
  EXPECT_THAT(input_error([] { read_case("/nowhere/case.toml"); }), HasSubstr("/nowhere/case.toml"));
}

}  // namespace
}  // namespace talus::dem
