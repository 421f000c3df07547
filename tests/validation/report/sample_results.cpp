#include "tests/validation/report/sample_results.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace talus::testing {
namespace {

using nlohmann::json;

constexpr double column_length = 0.048;  // m
constexpr double grain_radius = 0.0015;  // m
constexpr double run_time = 0.7;         // s

struct Shape {
  const char* backend;
  int seed;
  double runout;  // over L0
  double height;  // over L0
};
constexpr Shape shapes[] = {
    {"continuum", 1, 1.31, 0.70}, {"continuum", 2, 1.30, 0.705}, {"liggghts", 1, 1.22, 0.72},
    {"liggghts", 2, 1.27, 0.71},  {"yade", 1, 1.18, 0.73},       {"yade", 2, 1.25, 0.725},
};

/// Depth of the made-up deposit over L0, at x over L0.
double depth(const Shape& shape, double x) {
  return shape.height * std::max(0.0, 1.0 - std::pow(x / (1.0 + shape.runout), 1.3));
}

json curves(const Shape& shape) {
  json out;
  for (int k = 0; k <= 70; ++k) {
    const double time = run_time * k / 70;
    const double done = 1.0 - std::exp(-std::pow(time / 0.12, 2));
    const double jitter = shape.backend[0] == 'c' ? 0.0 : 0.02 * std::sin(9.0 * k + shape.seed);
    out["time"].push_back(time);
    out["front"].push_back(column_length * (1.0 + (shape.runout + jitter) * done));
    out["x95"].push_back(column_length * (0.95 + 0.6 * shape.runout * done));
    out["centre_of_mass"].push_back(column_length * (0.5 + 0.2 * shape.runout * done));
    out["height"].push_back(column_length * (1.0 + (shape.height - 1.0) * done));
  }
  return out;
}

json final_profile(const Shape& shape) {
  json out;
  for (double x = 0.03; x < 2.6; x += 0.06) {
    out["x"].push_back(column_length * x);
    out["depth"].push_back(column_length * depth(shape, x));
  }
  return out;
}

json run_of(const Shape& shape) {
  const bool continuum = std::string(shape.backend) == "continuum";
  json run{{"backend", shape.backend},
           {"seed", shape.seed},
           {"status", "ok"},
           {"input_hash", "7e57da7a"},
           {"version", continuum ? "0.1.0" : (shape.backend[0] == 'l' ? "3.8.0" : "2023.02a")},
           {"time_step_s", continuum ? 1e-3 : 3.5e-5},
           {"wall_s", continuum ? 14.2 : 31.9},
           {"cpu_s", continuum ? 13.9 : 31.5},
           {"count", continuum ? 2048 : 1128},
           {"solver", nullptr},
           {"preflight", nullptr},
           {"curves", curves(shape)},
           {"final_profile", final_profile(shape)}};
  run["observables"] = {{"runout", shape.runout},
                        {"x90", 1.0 + 0.48 * shape.runout},
                        {"x95", 0.95 + 0.6 * shape.runout},
                        {"centre_of_mass", 0.5 + 0.2 * shape.runout},
                        {"final_height", shape.height},
                        {"stop_time", 0.31},
                        {"settled_height", 0.998},
                        {"settled_volume_fraction", 0.574},
                        {"at_rest", true}};
  if (continuum) {
    run["solver"] = {{"steps", 700},
                     {"cap_hits", 0},
                     {"friction_iterations", 48211},
                     {"pressure_iterations", 90555},
                     {"converged", true},
                     {"mass_error", 3.1e-14}};
  } else {
    run["preflight"] = {{"rayleigh_fraction", 0.199}, {"hertz_fraction", 0.083}};
  }
  return run;
}

json row(const char* observable, double continuum, double liggghts, double yade, double band,
         const char* verdict, const char* why) {
  const auto statistics = [](double mean, int count) {
    return json{{"mean", mean}, {"sd", 0.02 * mean}, {"n", count}};
  };
  const double reference = 0.5 * (liggghts + yade);
  return {{"observable", observable},
          {"unit", "L0"},
          {"continuum", statistics(continuum, 2)},
          {"liggghts", statistics(liggghts, 2)},
          {"yade", statistics(yade, 2)},
          {"reference", statistics(reference, 4)},
          {"deviation", (continuum - reference) / reference},
          {"band", band},
          {"verdict", verdict},
          {"why", why}};
}

}  // namespace

json sample_results() {
  json runs = json::array();
  for (const Shape& shape : shapes) runs.push_back(run_of(shape));
  json column{{"name", "column_collapse"},
              {"title", "Column collapse, a = 1 (TEST DATA, not measured)"},
              {"file", "dem_cases/column_collapse/case.toml"},
              {"input_hash", "7e57da7a7e57da7a7e57da7a7e57da7a7e57da7a7e57da7a7e57da7a7e57da7a"},
              {"column_length_m", column_length},
              {"runs", runs},
              {"verdict", "FAIL"}};
  column["parameters"] = {
      {"geometry",
       {{"column_length_m", column_length},
        {"column_height_m", 0.048},
        {"thickness_m", 0.012},
        {"rough_floor", true}}},
      {"grains", {{"diameter_m", 0.003}, {"density_kg_m3", 2500}, {"youngs_modulus_pa", 5e6}}},
      {"contact", {{"friction", 0.5}, {"rolling_friction", 0.2}, {"restitution", 0.5}}},
      {"protocol", {{"run_time_s", run_time}, {"time_step_s", 3.5e-5}}},
      {"seeds", {1, 2}}};
  column["calibration"] = {{"name", "rolling 0.2"},        {"file", "dem_cases/calibration.toml"},
                           {"input_hash", "7e57ca11"},     {"friction_angle_deg", 31.1},
                           {"max_volume_fraction", 0.564}, {"status", "provisional"},
                           {"source", "made up for tests"}};
  column["summary"] = {row("x90", 1.626, 1.597, 1.583, 0.05, "PASS", "+2.3 % is inside the band"),
                       row("x95", 1.733, 1.697, 1.679, 0.05, "PASS", "+2.7 % is inside the band"),
                       row("centre_of_mass", 0.761, 0.749, 0.743, 0.05, "PASS", "+2.0 % is inside the band"),
                       row("runout", 1.305, 1.245, 1.215, 0.05, "FAIL", "+6.1 % is outside the band of 5 %"),
                       row("final_height", 0.703, 0.715, 0.728, 0.05, "INCONCLUSIVE",
                           "the scatter of the reference is wider than the band")};
  json provenance{{"version", "0.1.0"},
                  {"git_hash", "7e57da7a7e57da7a7e57da7a7e57da7a7e57da7a"},
                  {"git_dirty", true},
                  {"compiler", "g++ 12.2.0"},
                  {"compiler_flags", "-O3 -DNDEBUG"},
                  {"build_type", "Release"},
                  {"host", "test-host"},
                  {"cpu", "a made-up CPU"},
                  {"cores", 2},
                  {"time_utc", "2000-01-01T00:00:00Z"},
                  {"command_line", "talus-validate run smoke --out /tmp/out"}};
  provenance["libraries"] = {{"eigen", "3.4.0"}, {"hdf5", "1.10.8"}, {"gsl", "2.7.1"}};
  provenance["programs"] = {{"continuum", "talus 0.1.0"}, {"liggghts", "3.8.0"}, {"yade", "2023.02a"}};
  return {{"schema", "talus-results"}, {"schema_version", 1},      {"suite", "smoke"},
          {"complete", true},          {"provenance", provenance}, {"cases", json::array({column})},
          {"verdict", "FAIL"}};
}

json sample_pictures() {
  json pictures = json::array();
  for (const Shape& shape : shapes) {
    std::mt19937 random(static_cast<unsigned>(shape.seed));
    std::uniform_real_distribution<double> across(0.0, 1.0 + shape.runout);
    std::uniform_real_distribution<double> up(0.0, shape.height);
    json picture{
        {"case", "column_collapse"}, {"backend", shape.backend}, {"seed", shape.seed}, {"time", run_time}};
    for (int item = 0; item < 1100;) {
      const double x = across(random);
      const double z = up(random);
      if (z > depth(shape, x)) continue;
      picture["x"].push_back(column_length * x);
      picture["z"].push_back(column_length * z + grain_radius);
      picture["radius"].push_back(grain_radius);
      picture["x0"].push_back(column_length * std::pow(x / (1.0 + shape.runout), 0.8));
      ++item;
    }
    pictures.push_back(picture);
  }
  return pictures;
}

}  // namespace talus::testing
