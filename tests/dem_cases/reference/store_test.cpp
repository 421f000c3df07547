#include "dem_cases/reference/store.h"

#include <gmock/gmock.h>

#include "continuum/files/atomic_file.h"
#include "dem_cases/reference/table.h"
#include "tests/test_folder.h"

namespace talus::dem {
namespace {

using ::testing::HasSubstr;
using testing::input_error;
using ::testing::Not;
using testing::TestFolder;

nlohmann::json record(const std::string& code, std::uint64_t seed, double runout,
                      const std::string& hash = "abc") {
  return {{"case", "column"}, {"point", "a_1"},     {"code", code},  {"seed", seed},
          {"version", "1.0"}, {"input_hash", hash}, {"cpu_s", 10.0}, {"observables", {{"runout", runout}}}};
}

PlannedRun planned(const std::string& code, std::uint64_t seed) {
  PlannedRun run{};
  run.case_name = "column";
  run.point_name = "a_1";
  run.code = code;
  run.seed = seed;
  run.version = "1.0";
  return run;
}

TEST(Store, FindsWhatWasStoredAndOnlyThat) {
  const TestFolder folder;
  EXPECT_FALSE(find_record(folder.path(), planned("yade", 1), "abc"));
  store_record(folder.path(), record("yade", 1, 1.2));
  store_record(folder.path(), record("liggghts", 2, 1.3));
  ASSERT_TRUE(find_record(folder.path(), planned("yade", 1), "abc"));
  EXPECT_EQ(find_record(folder.path(), planned("yade", 1), "abc")->at("observables").at("runout"), 1.2);
  EXPECT_FALSE(find_record(folder.path(), planned("yade", 2), "abc"));      // another seed
  EXPECT_FALSE(find_record(folder.path(), planned("yade", 1), "changed"));  // other inputs
  PlannedRun newer = planned("yade", 1);
  newer.version = "1.1";
  EXPECT_FALSE(find_record(folder.path(), newer, "abc"));
}

TEST(Store, ANewRecordTakesThePlaceOfTheOld) {
  const TestFolder folder;
  store_record(folder.path(), record("yade", 1, 1.2, "old"));
  store_record(folder.path(), record("yade", 1, 1.4, "new"));
  const auto records = read_records(folder.path(), "column", "a_1");
  ASSERT_EQ(records.size(), 1U);
  EXPECT_EQ(records[0].at("input_hash"), "new");
}

TEST(Store, DamagedFileIsAClearErrorAndIsNotOverwritten) {
  const TestFolder folder;
  store_record(folder.path(), record("yade", 1, 1.2));
  const auto file = record_file(folder.path(), "column", "a_1");
  const std::string half = read_file(file).substr(0, 100);
  write_file_atomically(file, half);
  EXPECT_THAT(input_error([&] { store_record(folder.path(), record("yade", 2, 1.2)); }),
              HasSubstr("a_1.json: damaged"));
  EXPECT_EQ(read_file(file), half);
  write_file_atomically(file, R"({"format": "something", "version": 1, "runs": []})");
  EXPECT_THAT(input_error([&] { read_records(folder.path(), "column", "a_1"); }),
              HasSubstr("is not a talus-reference"));
}

TEST(Store, TableHasMeansSpreadsAndCosts) {
  const TestFolder folder;
  store_record(folder.path(), record("liggghts", 1, 1.0));
  store_record(folder.path(), record("liggghts", 2, 2.0));
  store_record(folder.path(), record("yade", 1, 1.2));
  const std::string table = reference_table(folder.path());
  EXPECT_THAT(table, HasSubstr("| column | a_1 | runout | 1.5 +- 0.71 (2) | 1.2 (1) | -20.0 % | 1.35 +- "));
  EXPECT_THAT(table, HasSubstr("liggghts: 2 runs, 20 CPU-s"));
  EXPECT_THAT(table, Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace talus::dem
