#include "validation/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"
#include "continuum/files/provenance.h"
#include "dem_cases/time_step.h"
#include "validation/backends/balances.h"
#include "validation/backends/continuum.h"
#include "validation/corrected.h"
#include "validation/gates/drift.h"
#include "validation/gates/truth.h"
#include "validation/gates/values.h"
#include "validation/metrics.h"
#include "validation/parameters.h"

namespace talus::validation {
namespace {

using nlohmann::json;

constexpr int schema_version = 2;

/// Mean C of the discrete runs times what k is uncertain by.
double beverloo_uncertainty(const dem::Case& a_case, const json& runs) {
  double largest = 0.0;
  for (const char* code : {"liggghts", "yade"}) {
    for (const double C : values_of(runs, code, "beverloo_C")) {
      if (std::isfinite(C)) largest = std::max(largest, C);
    }
  }
  return edge_width_effect(a_case) * largest;
}

/// The standard uncertainty that the ruler itself adds, in the observable's unit: what the fit of an angle or a rate is uncertain by, and for
/// the front the bin it may lie anywhere in.
double measuring_uncertainty(const dem::Case& a_case, const std::string& observable, const json& runs) {
  if (observable == "runout")
    return a_case.ruler.profile_bin / (2.0 * std::numbers::sqrt3) / cell_length(a_case);
  double largest = 0.0;
  for (const char* suffix : {"_error", "_fit_error"}) {
    for (const char* code : {"liggghts", "yade"}) {
      const auto errors = values_of(runs, code, observable + suffix);
      if (errors.empty()) continue;
      const double mean = analysis::ensemble_statistics(errors).mean;
      if (std::isfinite(mean)) largest = std::max(largest, mean);
    }
  }
  return observable == "beverloo_C" ? std::hypot(largest, beverloo_uncertainty(a_case, runs)) : largest;
}

json bands_of(const dem::Case& a_case, const json& runs) {
  json bands = json::array();
  for (const auto& band : a_case.observables) {
    bands.push_back({{"observable", band.name},
                     {"unit", unit_of(a_case, band.name)},
                     {"band", band.relative_band},
                     {"why", band.why},
                     {"measuring", measuring_uncertainty(a_case, band.name, runs)}});
  }
  for (const ExactLaw& law : exact_laws) {
    const auto model = runs_of(runs, continuum_code);
    if (std::ranges::none_of(
            model, [&](const json* run) { return run->at("observables").contains(law.observable); }))
      continue;
    bands.push_back({{"observable", law.observable},
                     {"unit", "1"},
                     {"band", law.band},
                     {"why", law.why},
                     {"measuring", 0.0},
                     {"exact", 1.0}});
  }
  return bands;
}

json preflight(const dem::Case& a_case) {
  const dem::TimeStepCheck check = dem::check_time_step(a_case);
  return {{"time_step_s", a_case.protocol.time_step},
          {"rayleigh_time_s", check.rayleigh_time},
          {"rayleigh_fraction", check.rayleigh_fraction},
          {"hertz_time_s", check.hertz_time},
          {"hertz_fraction", check.hertz_fraction}};
}

/// The record as results.json holds it: what all codes' runs have in common is filled in.
json run_json(const SuitePoint& point, FoundRecord found) {
  json run = std::move(found.record);
  run["status"] = "ok";
  run["origin"] = found.origin;
  if (run.at("code") == "liggghts" || run.at("code") == "yade") {
    run["count"] = run.value("grains", json());
    run["time_step_s"] = point.a_case.protocol.time_step;
    run["thickness_m"] = dem::periodic_thickness(point.a_case.geometry);
    run["preflight"] = preflight(point.a_case);
    run["solver"] = nullptr;
  } else {
    run["preflight"] = nullptr;
  }
  add_beverloo_C(point.a_case, run);
  return run;
}

json point_json(const Suite& suite, const SuitePoint& point, const std::vector<SuiteRun>& runs) {
  json records = json::array();
  for (const auto& run : runs) {
    if (run.point != point.name()) continue;
    auto found = find_record(run);
    if (!found)
      throw InputError(
          fmt::format("{}: this run is not there; make it with 'talus-validate run'", run.name()));
    records.push_back(run_json(point, std::move(*found)));
  }
  const dem::Case& a_case = point.a_case;
  return {{"case", a_case.name},
          {"point", a_case.point},
          {"name", point.name()},
          {"kind", a_case.kind},
          {"family", family_of(a_case)},
          {"title", a_case.title},
          {"file", std::filesystem::absolute(a_case.file).string()},
          {"input_hash", a_case.input_hash},
          {"tags", point.tags},
          {"length_unit", length_unit_of(a_case)},
          {"parameters", parameters_of(point)},
          {"calibration", calibration_of(suite, point)},
          {"bands", bands_of(a_case, records)},
          {"runs", records}};
}

}  // namespace

json assemble_results(const Suite& suite, const std::vector<SuiteRun>& runs,
                      const std::string& command_line) {
  json results{{"schema", "talus-results"},
               {"schema_version", schema_version},
               {"suite", suite.name},
               {"title", suite.title},
               {"tag", suite.tag},
               {"suite_file", std::filesystem::absolute(suite.file).string()},
               {"calibration_file", std::filesystem::absolute(suite.calibration).string()},
               {"calibration_hash", suite.calibration_hash},
               {"provenance", provenance()},
               {"points", json::array()}};
  results["provenance"]["command_line"] = command_line;
  results["provenance"]["suite_hash"] = suite.input_hash;
  for (const auto& run : runs) results["provenance"]["programs"][run.run.code] = run.run.version;
  for (const auto& point : suite.points) results["points"].push_back(point_json(suite, point, runs));
  results["complete"] = true;
  return results;
}

/// The largest u_codes of each observable, of points that both discrete codes have run.
static std::map<std::string, double> code_spread_of(const json& points) {
  std::map<std::string, double> spread;
  for (const auto& point : points) {
    for (const auto& row : judge_truth(point).rows) {
      const auto& codes = row.at("u_reference").at("codes");
      if (codes.is_number())
        spread[row.at("observable")] = std::max(spread[row.at("observable")], codes.get<double>());
    }
  }
  return spread;
}

void judge(json& results, const std::filesystem::path& baseline) {
  // Nothing to judge is no pass.
  Verdict verdict = Verdict::inconclusive;
  bool any = false;
  const auto spread = code_spread_of(results.at("points"));
  for (auto& point : results.at("points")) {
    const TruthJudgement judgement = judge_truth(point, spread);
    point["truth"] = judgement.rows;
    point["verdict"] = verdict_text(judgement.verdict);
    if (judgement.rows.empty()) continue;  // the continuum does not run it
    verdict = any ? worse(verdict, judgement.verdict) : judgement.verdict;
    any = true;
  }
  // A part of a suite does not speak for the whole.
  if (!results.value("tag", "").empty()) verdict = worse(verdict, Verdict::inconclusive);
  results["verdict"] = verdict_text(verdict);
  judge_drift_of_suite(results, baseline);
  results["metrics"] = suite_metrics(results);
  results["beverloo"] = beverloo_fits(results);
}

json read_results(const std::filesystem::path& folder) {
  const auto file = folder / results_name;
  json results;
  try {
    results = json::parse(read_file(file));
  } catch (const json::exception& error) {
    throw InputError(fmt::format("{}: not whole: {}; run the suite again", file.string(), error.what()));
  }
  if (!results.is_object() || results.value("schema", "") != "talus-results" ||
      results.value("schema_version", 0) != schema_version) {
    throw InputError(fmt::format("{}: not talus-results of schema version {}; run the suite again",
                                 file.string(), schema_version));
  }
  if (!results.value("complete", false))
    throw InputError(fmt::format("{}: not complete; run the suite again", file.string()));
  return results;
}

std::string why_stale(const json& results) {
  const auto gone = [](const std::string& file) {
    return file + " is not there, so these results cannot be checked against it";
  };
  const auto changed = [](const std::string& what) {
    return what + " has changed since these results were made";
  };
  const std::string suite_file = results.at("suite_file");
  if (!std::filesystem::exists(suite_file)) return gone(suite_file);
  if (sha256(read_file(suite_file)) != results.at("provenance").at("suite_hash")) return changed(suite_file);
  for (const auto& point : results.at("points")) {
    const std::string file = point.at("file");
    if (!std::filesystem::exists(file)) return gone(file);
    if (sha256(read_file(file)) != point.at("input_hash")) return changed(file);
  }
  Suite suite = read_suite(suite_file);
  if (suite.calibration_hash != results.at("calibration_hash")) return changed(suite.calibration.string());
  for (auto& point : suite.points)
    std::erase_if(point.seeds, [](const auto& seeds) { return seeds.first != continuum_code; });
  std::map<std::string, std::pair<std::string, std::string>> now;  // input hash and version by name
  for (const auto& run : plan_runs(suite, {})) now[run.name()] = {input_hash_of(run), run.run.version};
  for (const auto& point : results.at("points")) {
    for (const auto& run : point.at("runs")) {
      const std::string code = run.at("code");
      if (code == "liggghts" || code == "yade")
        continue;  // their inputs are the case's, which has not changed
      const auto found = now.find(fmt::format("{}/{}/{}", point.at("name").get<std::string>(), code,
                                              run.at("seed").get<std::uint64_t>()));
      if (found == now.end() || found->second.first != run.at("input_hash"))
        return changed("what the continuum is asked at " + point.at("name").get<std::string>());
      if (found->second.second != run.at("version")) return changed("the program talus");
    }
  }
  return {};
}

}  // namespace talus::validation
