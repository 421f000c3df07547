#include "tests/validation/report/sample_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/validation/report/sample_shapes.h"

namespace talus::testing {
namespace {

using nlohmann::json;

json column_curves(const Shape& shape) {
  json out;
  for (int k = 0; k <= 70; ++k) {
    const double time = run_time * k / 70, done = done_at(time);
    const double jitter = is_continuum(shape.code) ? 0.0 : 0.02 * std::sin(9.0 * k + shape.seed);
    out["time"].push_back(time);
    out["front"].push_back(column_length * (1.0 + (shape.runout + jitter) * done));
    out["x95"].push_back(column_length * (0.95 + 0.6 * shape.runout * done));
    out["centre_of_mass"].push_back(column_length * (0.5 + 0.2 * shape.runout * done));
    out["height"].push_back(column_length * (1.0 + (shape.height - 1.0) * done));
  }
  return out;
}

json column_profile(const Shape& shape) {
  json out;
  for (double x = 0.03; x < 2.6; x += 0.06) {
    out["x"].push_back(column_length * x);
    out["depth"].push_back(column_length * depth(shape, x, 1.0));
  }
  return out;
}

json bare_run(const char* code, int seed) {
  const bool continuum = is_continuum(code);
  return {{"code", code},
          {"seed", seed},
          {"status", "ok"},
          {"origin", continuum ? "run" : "ensemble"},
          {"input_hash", "7e57da7a"},
          {"version", continuum ? "0.1.0" : (code[0] == 'l' ? "3.8.0" : "2023.02a")},
          {"command", {continuum ? "talus" : code, "run", "scene.toml"}},
          {"made_by", {{"host", "test-host"}, {"compiler", "g++ 12.2.0"}}},
          {"time_step_s", continuum ? 1e-3 : 3.5e-5},
          {"thickness_m", continuum ? 0.0024 : 0.012},
          {"wall_s", continuum ? 1.6 : 31.9},
          {"cpu_s", continuum ? 1.5 : 31.5},
          {"count", continuum ? 2048 : 1128},
          {"solver", nullptr},
          {"preflight", nullptr}};
}

json column_run(const Shape& shape) {
  json run = bare_run(shape.code, shape.seed);
  run["curves"] = column_curves(shape);
  run["final_profile"] = column_profile(shape);
  run["observables"] = {{"runout", shape.runout},
                        {"x90", 1.0 + 0.48 * shape.runout},
                        {"x95", 0.95 + 0.6 * shape.runout},
                        {"centre_of_mass", 0.5 + 0.2 * shape.runout},
                        {"final_height", shape.height},
                        {"stop_time", 0.31},
                        {"settled_height", 0.998},
                        {"settled_volume_fraction", 0.574},
                        {"at_rest", true}};
  if (is_continuum(shape.code)) {
    run["solver"] = {{"steps", 700}, {"cap_hits", 0}, {"converged", true}, {"mass_error", 3.1e-14}};
  } else {
    run["preflight"] = {{"rayleigh_fraction", 0.199}, {"hertz_fraction", 0.083}};
  }
  return run;
}

json statistics(double mean, int count) { return {{"mean", mean}, {"sd", 0.02 * mean}, {"n", count}}; }

/// One row of the truth gate. `spread`: the relative uncertainty that decides it.
json truth_row(const char* observable, const char* unit, double continuum, double liggghts, double yade,
               double band, double spread, const char* verdict, const char* why) {
  const double reference = 0.5 * (liggghts + yade);
  return {{"observable", observable},
          {"unit", unit},
          {"continuum", statistics(continuum, 2)},
          {"liggghts", statistics(liggghts, 3)},
          {"yade", statistics(yade, 3)},
          {"reference", reference},
          {"deviation", (continuum - reference) / reference},
          {"band", band},
          {"band_why", "practical: what an engineer would notice"},
          {"u_reference",
           {{"seeds", 0.4 * spread},
            {"codes", 0.2 * spread},
            {"measuring", 0.0004},
            {"combined", 0.45 * spread}}},
          {"u_numerical",
           {{"seeds", 0.1 * spread},
            {"grid", 0.18 * spread},
            {"time_step", 0.02 * spread},
            {"combined", 0.21 * spread}}},
          {"coverage_factor", 2},
          {"uncertainty", spread},
          {"verdict", verdict},
          {"why", why}};
}

json drift_row(const char* observable, const char* unit, double baseline, double now, double tolerance,
               const char* verdict, const char* why) {
  return {{"observable", observable},       {"unit", unit},           {"baseline", baseline}, {"now", now},
          {"change", now / baseline - 1.0}, {"tolerance", tolerance}, {"verdict", verdict},   {"why", why}};
}

json calibration() {
  return {{"name", "rolling 0.2"},
          {"file", "dem_cases/calibration.toml"},
          {"input_hash", "7e57ca11"},
          {"status", "provisional"},
          {"source", "made up for tests"},
          {"friction_angle_deg", 31.099999999999998},
          {"mu_1", 0.49},
          {"mu_2", 0.91},
          {"I_0", 0.31},
          {"max_volume_fraction", 0.564}};
}

json column() {
  json point{{"case", "column_collapse"},
             {"point", "a_1"},
             {"name", "column_collapse/a_1"},
             {"kind", "column_collapse"},
             {"family", "column collapse"},
             {"title", "Column collapse, a = 1 (TEST DATA, not measured)"},
             {"file", "dem_cases/column_collapse/case.toml"},
             {"input_hash", "7e57da7a7e57da7a7e57da7a7e57da7a7e57da7a7e57da7a7e57da7a7e57da7a"},
             {"tags", {"quick"}},
             {"length_unit", {{"symbol", "L0"}, {"metres", column_length}}},
             {"calibration", calibration()},
             {"verdict", "FAIL"},
             {"drift_verdict", "PASS"}};
  point["runs"] = json::array();
  for (const Shape& shape : shapes) point["runs"].push_back(column_run(shape));
  point["parameters"] = {
      {"geometry",
       {{"column_length_m", column_length},
        {"column_height_m", 0.048},
        {"thickness_m", 0.012},
        {"rough_floor", true}}},
      {"grains", {{"diameter_m", grain_diameter}, {"density_kg_m3", 2500}, {"youngs_modulus_pa", 5e6}}},
      {"contact", {{"friction", 0.5}, {"rolling_friction", 0.2}, {"restitution", 0.5}}},
      {"protocol", {{"run_time_s", run_time}, {"time_step_s", 3.5e-5}}}};
  point["truth"] = {
      truth_row("x95", "L0", 1.733, 1.697, 1.679, 0.05, 0.021, "PASS", "+2.7 % is inside the band of 5 %"),
      truth_row("centre_of_mass", "L0", 0.761, 0.749, 0.743, 0.05, 0.018, "PASS",
                "+2.0 % is inside the band of 5 %"),
      truth_row("runout", "L0", 1.305, 1.155, 1.125, 0.10, 0.030, "FAIL",
                "+14.5 % is outside the band of 10 %"),
      truth_row("final_height", "L0", 0.703, 0.715, 0.728, 0.10, 0.140, "INCONCLUSIVE",
                "the uncertainty is wider than the band")};
  json profile = truth_row("profile_L1", "1", 0.0, 0.0, 0.0, 0.12, 0.03, "PASS",
                           "the profiles differ by 6.4 % of the area");
  for (const char* part : {"continuum", "liggghts", "yade", "reference"}) profile[part] = nullptr;
  profile["deviation"] = 0.064;
  point["truth"].push_back(profile);
  point["drift"] = {drift_row("x95", "L0", 1.7331, 1.733, 0.002, "PASS", "inside the tolerance"),
                    drift_row("runout", "L0", 1.305, 1.305, 0.002, "PASS", "unchanged")};
  return point;
}

json slot() {
  json point{
      {"case", "slot"},         {"point", "opening_8d"},        {"name", "slot/opening_8d"},
      {"kind", "slot"},         {"family", "hourglass"},        {"title", "Slot, opening 8 d (TEST DATA)"},
      {"length_unit", nullptr}, {"calibration", calibration()}, {"verdict", "PASS"},
      {"drift_verdict", "FAIL"}};
  for (const char* code : {"continuum", "liggghts", "yade"}) {
    for (const int seed : {1, 2}) {
      json run = bare_run(code, seed);
      const double rate = (is_continuum(code) ? 0.140 : 0.144) + 0.001 * seed;
      run["observables"] = {{"discharge_rate", rate},
                            {"discharge_rate_error", 0.0027},
                            {"emptied_time", 1.13},
                            {"residual", 0.125}};
      for (int k = 0; k <= 60; ++k) {
        run["curves"]["time"].push_back(0.02 * k);
        run["curves"]["mass"].push_back(std::max(0.017, 0.136 - rate * 0.02 * k));
      }
      point["runs"].push_back(run);
    }
  }
  point["truth"] = {truth_row("discharge_rate", "kg/s", 0.1415, 0.1455, 0.1448, 0.08, 0.035, "PASS",
                              "-2.5 % is inside the band of 8 %")};
  point["drift"] = {drift_row("discharge_rate", "kg/s", 0.1385, 0.1415, 0.005, "FAIL",
                              "+2.2 % is beyond the tolerance of 0.5 %")};
  return point;
}

json heap() {
  json point{{"case", "heap"},
             {"point", "radius_8d"},
             {"name", "heap/radius_8d"},
             {"kind", "heap"},
             {"family", "pile angle"},
             {"title", "Heap on a disc (TEST DATA)"},
             {"verdict", "INCONCLUSIVE"},
             {"drift_verdict", "INCONCLUSIVE"}};
  for (const char* code : {"continuum", "liggghts"}) {
    json run = bare_run(code, 1);
    run["observables"] = {{"repose_angle", is_continuum(code) ? 24.9 : 25.76}, {"crest_height", 0.0288}};
    run["curves"] = json::object();
    for (double x = 0.0; x < 0.06; x += 0.002) {
      run["final_profile"]["x"].push_back(x);
      run["final_profile"]["depth"].push_back(std::max(0.0, 0.0288 - 0.48 * x));
    }
    point["runs"].push_back(run);
  }
  point["truth"] = {truth_row("repose_angle", "deg", 24.9, 25.76, 25.76, 0.078, 0.09, "INCONCLUSIVE",
                              "only one discrete code has run")};
  point["truth"][0]["yade"] = nullptr;
  point["drift"] = {
      drift_row("repose_angle", "deg", 24.9, 24.9, 0.002, "INCONCLUSIVE", "a solve did not converge")};
  return point;
}

json metric(const char* observable, int n, double bias, double band, double p) {
  return {{"observable", observable},
          {"n", n},
          {"bias_factor", bias},
          {"bias_interval", {bias - 0.02, bias + 0.02}},
          {"model_relative_sd", 0.034},
          {"model_relative_sd_interval", {0.021, 0.062}},
          {"reference_relative_sd", 0.012},
          {"equivalence", {{"band", band}, {"p", p}, {"equivalent", p < 0.05}}}};
}

json fit(const char* code, double scale) {
  json out{{"code", code}, {"material", "rolling 0.2"}, {"C", 1.02 * scale}, {"C_error", 0.03},
           {"k", 1.4},     {"k_error", 0.12},           {"exponent", 1.48},  {"exponent_error", 0.05}};
  for (const int diameters : {8, 12, 16}) {
    const double opening = diameters * grain_diameter;
    out["points"].push_back({{"opening_m", opening},
                             {"rate_kg_s", scale * 60.0 * std::pow(opening - 1.4 * grain_diameter, 1.5)}});
  }
  return out;
}

json mutants() {
  return {{{"name", "no_friction"},
           {"title", "no friction"},
           {"killed", true},
           {"runs", 4},
           {"by", {{{"name", "column_collapse/a_1"}, {"observable", "runout"}, {"verdict", "FAIL"}}}}},
          {{"name", "gravity_5"},
           {"title", "gravity off by 5 %"},
           {"killed", false},
           {"by", json::array()},
           {"runs", 4}}};
}

}  // namespace

json sample_results() {
  json provenance{{"version", "0.1.0"},
                  {"git_hash", "7e57da7a7e57da7a7e57da7a7e57da7a7e57da7a"},
                  {"git_dirty", true},
                  {"host", "test-host"},
                  {"time_utc", "2000-01-01T00:00:00Z"},
                  {"suite_hash", "7e575017"},
                  {"command_line", "talus-validate run smoke -o /tmp/out"},
                  {"programs", {{"continuum", "talus 0.1.0"}, {"liggghts", "3.8.0"}, {"yade", "2023.02a"}}}};
  const json baseline{{"when", "1999-12-31T00:00:00Z"},
                      {"who", "tester"},
                      {"why", "first baseline"},
                      {"git_hash", "ba5e11e0"}};
  json history = json::array({baseline});
  history[0]["changes"] = {
      {{"name", "column_collapse/a_1"}, {"observable", "x95"}, {"old", nullptr}, {"new", 1.7331}},
      {{"name", "long_gone/point"}, {"observable", "x95"}, {"old", 1.71}, {"new", 1.72}}};
  history.push_back(baseline);
  history[1]["why"] = "second baseline";
  history[1]["changes"] = {
      {{"name", "column_collapse/a_1"}, {"observable", "x95"}, {"old", 1.7331}, {"new", 1.78}}};
  return {{"schema", "talus-results"},
          {"schema_version", 2},
          {"suite", "smoke"},
          {"title", "the quick one"},
          {"complete", true},
          {"provenance", provenance},
          {"verdict", "FAIL"},
          {"drift", {{"verdict", "FAIL"}, {"why", "One observable moved."}, {"baseline", baseline}}},
          {"points", {column(), slot(), heap()}},
          {"metrics", {metric("x95", 12, 1.021, 0.05, 0.003), metric("runout", 12, 1.086, 0.10, 0.21)}},
          {"beverloo", {fit("continuum", 0.97), fit("liggghts", 1.0), fit("yade", 0.99)}},
          {"history", history},
          {"mutants", mutants()}};
}

json many_points(int count) {
  json results = sample_results();
  const json first = results["points"][0];
  for (int k = 3; k < count; ++k) {
    results["points"].push_back(first);
    results["points"].back()["name"] = fmt::format("column_collapse/copy_{}", k);
  }
  return results;
}

}  // namespace talus::testing
