// `talus bench` as a user meets it, and what both commands do with threads.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "analysis/snapshot.h"
#include "continuum/files/atomic_file.h"
#include "tests/program.h"

namespace talus {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::run_program;
using testing::TestFolder;

const std::string column = TALUS_SOURCE_DIR "/tests/continuum/data/small_column.toml";
const std::string cylinder = TALUS_SOURCE_DIR "/continuum/scenes/bench/cylinder_13k.toml";

nlohmann::json bench(const std::string& scene, std::vector<std::string> options) {
  const TestFolder folder;
  const auto file = folder.path() / "bench.json";
  options.insert(options.begin(), {"talus", "bench", scene, "--json", file.string()});
  const auto result = run_program(options);
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, AllOf(HasSubstr("CPU-s per simulated second"), HasSubstr("friction")));
  return nlohmann::json::parse(read_file(file));
}

/// Every number below `json` that is not finite (which JSON writes as null), by its path.
std::vector<std::string> without_value(const nlohmann::json& json) {
  std::vector<std::string> names;
  const nlohmann::json flat = json.flatten();
  for (const auto& [name, value] : flat.items()) {
    if (value.is_null()) names.push_back(name);
  }
  return names;
}

double sum_of_phases(const nlohmann::json& figures) {
  double sum = 0.0;
  std::vector<std::string> names;
  for (const auto& [name, seconds] : figures.at("phases_s").items()) {
    EXPECT_GE(seconds.get<double>(), 0.0) << name;
    sum += seconds.get<double>();
    names.push_back(name);
  }
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("region", "packing", "deposit", "carry_over", "friction",
                                                     "pressure", "stress_other", "move", "reshape",
                                                     "render_points", "warm_start", "other"));
  return sum;
}

TEST(TalusBench, TellsWhatASceneCosts) {
  const auto figures = bench(column, {"--threads", "1"});
  EXPECT_EQ(figures["schema"], "talus-bench");
  EXPECT_EQ(figures["schema_version"], 1);
  EXPECT_THAT(without_value(figures), ::testing::IsEmpty());
  EXPECT_EQ(figures["scene"], "small_column.toml");
  EXPECT_EQ(figures["input_hash"].get<std::string>().size(), 64u);
  EXPECT_TRUE(figures["provenance"].contains("git_hash"));
  EXPECT_EQ(figures["frames"], 5);
  EXPECT_NEAR(figures["simulated_s"].get<double>(), 0.045, 1e-12);
  EXPECT_EQ(figures["particles"], nlohmann::json({{"start", 200}, {"end", 200}, {"mean", 200.0}}));
  EXPECT_EQ(figures["threads"], 1);
  EXPECT_EQ(figures["cap_hits"], 0);
  for (const char* solve : {"friction", "pressure"}) {
    const auto& iterations = figures.at("iterations").at(solve);
    EXPECT_GT(iterations["total"], 0) << solve;
    EXPECT_DOUBLE_EQ(iterations["per_step"].get<double>() * figures["steps"].get<double>(),
                     iterations["total"].get<double>());
  }
  EXPECT_TRUE(figures["iterations"].contains("packing"));
  EXPECT_GT(figures["peak_mb"], 1.0);
  EXPECT_LT(figures["peak_mb"], 1000.0);
}

TEST(TalusBench, PeakMemoryIsTheScenesOwn) {
  const TestFolder folder;
  const auto file = folder.path() / "bench.json";
  const auto result =
      run_program({"talus", "bench", column, cylinder, column, "--frames", "1", "--json", file.string()});
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const auto figures = nlohmann::json::parse(read_file(file));
  const auto peak = [&](int scene) { return figures[scene]["peak_mb"].get<double>(); };
  EXPECT_LT(peak(2), 0.5 * (peak(0) + peak(1)));
}

TEST(TalusBench, ItsRatesAreThoseOfItsTotals) {
  const auto figures = bench(column, {"--threads", "1"});
  const auto value = [&](const char* name) { return figures.at(name).get<double>(); };
  const double cpu = value("cpu_s");
  EXPECT_GT(cpu, 0.0);
  EXPECT_LE(cpu, value("wall_s") + 0.05);  // one thread; the kernel counts in ticks
  EXPECT_NEAR(value("cpu_s_per_simulated_s"), cpu / 0.045, 1e-9 * cpu / 0.045);
  EXPECT_DOUBLE_EQ(value("cpu_s_per_step") * value("steps"), cpu);
  EXPECT_DOUBLE_EQ(value("cpu_s_per_frame") * 5.0, cpu);
  EXPECT_DOUBLE_EQ(value("ns_per_particle_step") * 1e-9 * 200.0 * value("steps"), cpu);
}

TEST(TalusBench, ThePhasesMakeUpTheTime) {
  for (const char* scheme : {"consistent", "paper"}) {
    const TestFolder folder;
    const auto scene = folder.path() / "scene.toml";
    std::ofstream(scene) << read_file(column) << "[solver]\nscheme = \"" << scheme << "\"\n";
    const auto figures = bench(scene.string(), {"--threads", "1"});
    const double wall = figures["wall_s"], sum = sum_of_phases(figures);
    EXPECT_LE(sum, wall) << scheme;
    EXPECT_GE(sum, 0.8 * wall) << scheme;
    for (const char* phase : {"region", "deposit", "friction", "pressure", "move", "warm_start", "other"})
      EXPECT_GT(figures["phases_s"][phase], 0.0) << scheme << " " << phase;
    EXPECT_EQ(figures["phases_s"]["render_points"], 0.0) << scheme;
  }
}

TEST(TalusBench, RenderPointsAreAPhaseOfTheirOwn) {
  const TestFolder folder;
  const auto scene = folder.path() / "scene.toml";
  std::ofstream(scene) << read_file(column) << "[render_points]\nper_particle = 2\n";
  const auto figures = bench(scene.string(), {"--threads", "1", "--frames", "1"});
  EXPECT_GT(figures["phases_s"]["render_points"], 0.0);
}

TEST(TalusBench, StopsAfterTheFramesAskedFor) {
  const auto figures = bench(column, {"--frames", "2"});
  EXPECT_EQ(figures["frames"], 2);
  EXPECT_NEAR(figures["simulated_s"].get<double>(), 0.02, 1e-12);
  EXPECT_GE(figures["threads"], 1);
}

TEST(TalusBench, BadInputIsOneErrorAndExitCodeTwo) {
  const TestFolder folder;
  const auto json = folder.path() / "bench.json";
  std::ofstream(folder.path() / "blocked") << "";
  const auto error = [&](const std::string& scene, std::vector<std::string> options) {
    options.insert(options.begin(), {"talus", "bench", scene});
    const auto result = run_program(options);
    EXPECT_EQ(result.exit_code, 2) << result.output;
    return result.output;
  };
  EXPECT_THAT(error("absent.toml", {"--json", json.string()}), HasSubstr("no such file"));
  EXPECT_THAT(error(column, {"--frames", "6", "--json", json.string()}),
              HasSubstr("--frames 6: the scene has 5"));
  EXPECT_THAT(error(column, {"--frames", "0"}), HasSubstr("--frames"));
  EXPECT_THAT(error(column, {"--threads", "0"}), HasSubstr("--threads"));
  EXPECT_THAT(error(column, {"--json", folder.path().string()}), HasSubstr("takes the name of a file"));
  EXPECT_THAT(error(column, {"--json", (folder.path() / "blocked" / "x.json").string()}),
              HasSubstr("cannot make this folder"));
  EXPECT_FALSE(std::filesystem::exists(json));
}

TEST(TalusThreads, LeaveTheResultsAsTheyAreToTheLastBit) {
  const TestFolder folder;
  const auto scene = folder.path() / "scene.toml";
  // 13,000 particles: many blocks of every loop. A cold step and some warm ones.
  std::ofstream(scene) << testing::replaced(read_file(cylinder), "end_s = 1.0", "end_s = 0.025");
  const auto last_snapshot = [&](const std::string& threads) {
    const auto output = folder.path() / ("threads_" + threads);
    const auto result =
        run_program({"talus", "run", scene.string(), "--output", output.string(), "--threads", threads});
    EXPECT_EQ(result.exit_code, 0) << result.output;
    EXPECT_THAT(result.output, HasSubstr(", " + threads + " threads"));
    return analysis::read_snapshots(output / "snapshots.h5").back();
  };
  const auto one = last_snapshot("1"), two = last_snapshot("2");
  EXPECT_GT(one.positions.cols(), 10000);
  EXPECT_EQ(one.time, two.time);
  EXPECT_EQ(one.positions, two.positions);
  EXPECT_EQ(one.velocities, two.velocities);
  EXPECT_EQ(one.volumes, two.volumes);
}

}  // namespace
}  // namespace talus
