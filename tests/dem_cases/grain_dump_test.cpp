#include "dem_cases/grain_dump.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "dem_cases/time_step.h"
#include "tests/dem_cases/case_files.h"

namespace talus::dem {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A made-up run in which no grain moves, written as the codes write it; each test spoils one thing in it.
class GrainDump : public ::testing::Test {
 protected:
  GrainDump() : column_(read_case(tiny_column_file)), packing_(make_packing(column_, 1)) {
    column_.protocol.run_time = 2 * column_.protocol.snapshot_interval;
    packing_.velocities.setZero();
  }

  std::string grain_line(Eigen::Index i) const {
    const auto p = packing_.positions.col(i);
    const auto v = packing_.velocities.col(i);
    return fmt::format("{} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g} {:.10g}\n", i + 1, p.x(), p.y(), p.z(),
                       v.x(), v.y(), v.z());
  }

  std::string dump_text() const {
    std::string text;
    for (const int step : {0, 200, 400}) {
      text += fmt::format("ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\n", step, packing_.mobile_count());
      text += "ITEM: BOX BOUNDS ff pp ff\n0 1\n0 1\n0 1\nITEM: ATOMS id x y z vx vy vz \n";
      for (Eigen::Index i = packing_.fixed_count; i < packing_.count(); ++i) text += grain_line(i);
    }
    return text;
  }

  /// Replaces the last occurrence, which is in the last snapshot.
  static std::string spoil_last(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.rfind(from), from.size(), to);
  }

  analysis::SnapshotSeries read(const std::string& text) const {
    write_file_atomically(folder_.path() / dump_file, text);
    return read_grain_dump(column_, packing_, folder_.path());
  }

  std::string refusal(const std::string& text) const {
    return input_error([&] { read(text); });
  }

  /// The dump with the sixth grain at another place in the last snapshot.
  std::string moved_grain(double x, double z) {
    const Eigen::Index i = packing_.fixed_count + 5;
    const std::string from = grain_line(i);
    const std::string text = dump_text();
    packing_.positions(0, i) = x;
    packing_.positions(2, i) = z;
    return spoil_last(text, from, grain_line(i));
  }

  TestFolder folder_;
  Case column_;
  Packing packing_;
};

TEST_F(GrainDump, ReadsBackWhatWasWritten) {
  packing_.positions(1, packing_.fixed_count) -= column_geometry(column_).thickness;  // one period over
  const auto series = read(dump_text());
  ASSERT_EQ(series.size(), 3U);
  EXPECT_EQ(series[0].time, 0.0);
  EXPECT_NEAR(series[1].time, 0.007, 1e-12);
  EXPECT_NEAR(series[2].time, 0.014, 1e-12);
  const auto mobile = packing_.mobile_count();
  ASSERT_EQ(series[2].positions.cols(), mobile);
  packing_.positions(1, packing_.fixed_count) += column_geometry(column_).thickness;
  EXPECT_TRUE(series[2].positions.isApprox(packing_.positions.rightCols(mobile), 1e-9));
  EXPECT_NEAR(series[2].volumes.sum(), packing_.mobile_volume(), 1e-12 * packing_.mobile_volume());
}

TEST_F(GrainDump, FindsALostGrain) {
  const std::string line = grain_line(packing_.fixed_count + 5);
  EXPECT_THAT(refusal(spoil_last(dump_text(), line, "")), AllOf(HasSubstr("grains.dump"), HasSubstr("lost")));
  const auto count = packing_.mobile_count();
  EXPECT_THAT(refusal(spoil_last(dump_text(), fmt::format("ATOMS\n{}\n", count),
                                 fmt::format("ATOMS\n{}\n", count - 1))),
              AllOf(HasSubstr("lost"), HasSubstr("step 400"), HasSubstr(std::to_string(count - 1))));
}

TEST_F(GrainDump, FindsALeakThroughTheFloor) {
  EXPECT_THAT(refusal(moved_grain(0.007, -0.003)),
              AllOf(HasSubstr(fmt::format("grain {}", packing_.fixed_count + 6)), HasSubstr("floor"),
                    HasSubstr("-0.003")));
}

TEST_F(GrainDump, FindsALeakThroughTheBackWall) {
  EXPECT_THAT(refusal(moved_grain(-0.001, 0.01)), HasSubstr("back wall"));
}

TEST_F(GrainDump, FindsALeakThroughTheFarWall) {
  EXPECT_THAT(refusal(moved_grain(0.13, 0.01)), HasSubstr("far wall"));
}

TEST_F(GrainDump, FindsATankThatIsTooShort) {
  EXPECT_THAT(refusal(moved_grain(column_geometry(column_).tank_length - 0.001, 0.01)),
              AllOf(HasSubstr("reached the far wall"), HasSubstr("tank_length_m")));
}

TEST_F(GrainDump, FindsALeakThroughTheGateBeforeItOpened) {
  packing_.positions(0, packing_.fixed_count) = column_geometry(column_).column_length + 0.001;
  EXPECT_THAT(refusal(dump_text()), HasSubstr("gate"));
}

TEST_F(GrainDump, FindsNumbersThatAreNone) {
  const std::string line = grain_line(packing_.fixed_count + 5);
  for (const char* bad : {"nan", "-nan", "inf"}) {
    const auto spoilt = fmt::format("{} {} 0.01 0.01 0 0 0\n", packing_.fixed_count + 6, bad);
    EXPECT_THAT(refusal(spoil_last(dump_text(), line, spoilt)), HasSubstr("not finite")) << bad;
  }
  const auto spoilt = fmt::format("{} 0.01 0.01 # 0 0 0\n", packing_.fixed_count + 6);
  EXPECT_THAT(refusal(spoil_last(dump_text(), line, spoilt)), HasSubstr("damaged"));
}

TEST_F(GrainDump, FindsAColumnThatWasNotAtRest) {
  packing_.velocities.row(2).setConstant(0.02);  // KE / (m g H0) = 1.4e-3
  EXPECT_THAT(refusal(dump_text()),
              AllOf(HasSubstr("not at rest"), HasSubstr("0.00136"), HasSubstr("settle_time_s")));
}

TEST_F(GrainDump, NeverTakesAPartForTheWhole) {
  const std::string whole = dump_text();
  const auto third = whole.size() / 3;
  for (const std::size_t size :
       {std::size_t{0}, third, third + 1, 2 * third, whole.size() - 30, whole.size() - 1}) {
    EXPECT_FALSE(refusal(whole.substr(0, size)).empty()) << size;
  }
  EXPECT_THAT(refusal(whole.substr(0, whole.rfind("ITEM: TIMESTEP"))), HasSubstr("2 snapshots of 3"));
}

TEST_F(GrainDump, FindsASnapshotThatIsOutOfOrder) {
  EXPECT_THAT(refusal(spoil_last(dump_text(), "STEP\n400\n", "STEP\n600\n")),
              AllOf(HasSubstr("600"), HasSubstr("400")));
}

TEST_F(GrainDump, ThereIsNone) {
  EXPECT_THAT(input_error([&] { read_grain_dump(column_, packing_, folder_.path()); }),
              HasSubstr("wrote no snapshot"));
}

TEST_F(GrainDump, ProgressCountsSettlingAndRun) {
  EXPECT_EQ(progress_of_run(column_, folder_.path()), 0.0);
  std::string text = "\n";  // as LIGGGHTS begins it
  for (int i = 0; i < 21; ++i) text += "settling\n";
  write_file_atomically(folder_.path() / progress_file, text);
  EXPECT_DOUBLE_EQ(progress_of_run(column_, folder_.path()), 21.0 / 42.0);  // 40 to settle, 2 to run
  for (int i = 0; i < 21; ++i) text += "running\n";
  write_file_atomically(folder_.path() / progress_file, text);
  EXPECT_DOUBLE_EQ(progress_of_run(column_, folder_.path()), 1.0);
}

}  // namespace
}  // namespace talus::dem
