// The benchmark of kernels runs: a line for every kernel, warm and cold, with figures that hang together.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <set>

#include "tests/program.h"

namespace talus {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string bench = TALUS_BINARY_DIR "/tests/continuum_kernels_bench";

nlohmann::json figures() {
  const testing::TestFolder folder;
  const auto file = folder.path() / "kernels.json";
  const auto result =
      testing::run_program({bench, "--benchmark_filter=/1x/", "--benchmark_min_time=0.0001",
                            "--benchmark_out_format=json", "--benchmark_out=" + file.string()},
                           120.0);
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("memory bandwidth, triad, one core: "));
  return nlohmann::json::parse(read_file(file));
}

/// The leading number of a context line, "12.73 GB/s".
double limit(const nlohmann::json& all, const char* name) {
  return std::stod(all.at("context").at(name).get<std::string>());
}

TEST(KernelsBench, TimesEveryKernelWarmAndColdAgainstTheMachine) {
  const auto all = figures();
  const double memory = limit(all, "memory bandwidth, triad, one core"),
               peak = limit(all, "peak, fused multiply-adds, one core");
  std::set<std::string> names, starts;
  for (const auto& one : all.at("benchmarks")) {
    const auto name = one.at("name").get<std::string>();
    const auto end = name.find("/1x/");
    ASSERT_NE(end, std::string::npos) << name;
    names.insert(name.substr(0, end));
    starts.insert(name.substr(end + 4, 4));
    const auto value = [&](const char* counter) { return one.at(counter).get<double>(); };
    EXPECT_GT(value("bytes"), 0.0) << name;
    EXPECT_GT(value("flops"), 0.0) << name;
    EXPECT_GE(value("iterations"), 0.0) << name;  // 0 where sweeps alone were enough
    EXPECT_NEAR(value("GB/s") / memory * value("distance"), 1.0, 1e-2) << name;
    EXPECT_NEAR(value("of_memory") * value("distance"), 1.0, 1e-9) << name;
    EXPECT_NEAR(value("of_L2") * value("distance_L2"), 1.0, 1e-9) << name;
    EXPECT_NEAR(value("GFLOP/s") / peak / value("of_peak"), 1.0, 1e-2) << name;
    EXPECT_LT(value("of_peak"), 1.0) << name << " computes more than the machine can";
    EXPECT_LT(value("of_L2"), 2.0) << name << " moves more than the machine can";
  }
  EXPECT_THAT(names, ElementsAre("D1", "D1_transpose", "D2", "D2_transpose", "advance", "carry_over",
                                 "density_correction", "deposit", "friction_apply",
                                 "friction_apply_transpose", "friction_solve", "gather", "make_active_region",
                                 "pressure_solve", "render_points", "split_and_merge"));
  EXPECT_THAT(starts, ElementsAre("cold", "warm"));
}

TEST(KernelsBench, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(testing::run_program({bench, "--fast"}, 60.0).exit_code, 2);
}

}  // namespace
}  // namespace talus
