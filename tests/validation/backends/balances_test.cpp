#include "validation/backends/balances.h"

#include <gmock/gmock.h>

#include "analysis/snapshot.h"
#include "continuum/files/atomic_file.h"
#include "tests/test_folder.h"

namespace talus::validation {
namespace {

const std::string header =
    "time_s,dt_s,mass_kg,bulk_volume_m3,wall_impulse_z_kg_m_s,solids_impulse_z_kg_m_s\n";

Balances balances_of(const std::string& rows) {
  const testing::TestFolder folder;
  write_file_atomically(folder.path() / "budget.csv", header + rows);
  return read_balances(folder.path() / "budget.csv", 1500.0, 10.0);
}

TEST(Balances, AreMeansOverTheLastTenth) {
  // Of 10 s the last: 2 kg in half a second weigh 10 N s, in which 6 + 1 and 9 + 2 are given.
  const auto b = balances_of("5,1,2,9,9,9\n9.5,0.5,2,0.001,1,6\n10,0.5,2,0.0014,2,9\n");
  EXPECT_DOUBLE_EQ(b.support, 18.0 / 20.0);
  EXPECT_DOUBLE_EQ(b.bulk_density, 2.0 / 0.0012 / 1500.0);
}

TEST(Balances, EndWhereAllSandHasLeft) {
  const auto b = balances_of("9,1,3,0.002,0,30\n10,1,3,0.002,0,15\n11,1,0,0,0,0\n99,1,0,0,0,0\n");
  EXPECT_DOUBLE_EQ(b.support, 0.75);
  EXPECT_DOUBLE_EQ(b.bulk_density, 1.0);
  EXPECT_THROW(balances_of("1,1,0,0,0,0\n"), analysis::SnapshotError);
  EXPECT_THROW(balances_of(""), analysis::SnapshotError);
}

}  // namespace
}  // namespace talus::validation
