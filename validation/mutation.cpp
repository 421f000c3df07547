#include "validation/mutation.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "continuum/files/input_error.h"
#include "validation/backends/continuum.h"
#include "validation/corrected.h"
#include "validation/gates/truth.h"
#include "validation/gates/values.h"
#include "validation/mutants.h"

namespace talus::validation {
namespace {

using nlohmann::json;

/// The suite's continuum alone, without refinement: the uncertainties are known from the suite itself.
Suite continuum_of(Suite suite) {
  std::erase_if(suite.points, [](const SuitePoint& point) { return !point.seeds.contains(continuum_code); });
  for (auto& point : suite.points) {
    point.refinement = false;
    std::erase_if(point.seeds, [](const auto& item) { return item.first != continuum_code; });
  }
  return suite;
}

/// The point with its continuum runs replaced by the mutant's.
json mutated(json point, const std::vector<json>& records) {
  json runs = json::array();
  for (const auto& run : point.at("runs")) {
    const std::string code = run.at("code");
    if (code == "liggghts" || code == "yade") runs.push_back(run);
  }
  for (const auto& record : records) runs.push_back(record);
  point["runs"] = runs;
  return point;
}

/// Those without unconverged solves; all where none is.
std::vector<json> converged_among(const std::vector<json>& records) {
  std::vector<json> found;
  std::ranges::copy_if(records, std::back_inserter(found),
                       [](const json& record) { return record.at("solver").at("converged") == true; });
  return found.empty() ? records : found;
}

/// What the gate says of a row by the uncertainty that it has without the mutant.
bool found_out(const json& before, double deviation) {
  if (before.at("verdict") == "FAIL" || !before.at("uncertainty").is_number()) return false;
  return std::abs(deviation) > before.at("band").get<double>() + before.at("uncertainty").get<double>();
}

const dem::Case& case_of(const Suite& suite, const std::string& point) {
  return std::ranges::find(suite.points, point, &SuitePoint::name)->a_case;
}

json try_mutant(const Mutant& mutant, const Suite& suite, const json& results,
                const std::filesystem::path& output, const MakingOptions& options) {
  spdlog::info("mutant: {}", mutant.title);
  json tried{{"name", mutant.name},
             {"title", mutant.title},
             {"rows", json::array()},
             {"by", json::array()},
             {"not_judged", json::array()}};
  const auto runs = plan_runs(suite, output / "mutants" / mutant.name, mutant.defects);
  try {
    make_runs(runs, options);
  } catch (const RunError&) {
    if (options.stop()) throw;  // a failure is an answer, and found below
  }
  tried["runs"] = runs.size();
  for (const auto& point : results.at("points")) {
    std::vector<json> records;
    bool failed = false, refused = false;
    for (const auto& run : runs) {
      if (run.point != point.at("name")) continue;
      if (auto found = find_record(run)) {
        add_beverloo_C(case_of(suite, run.point), found->record);
        records.push_back(std::move(found->record));
      } else {
        failed = true;
        refused = refused || std::filesystem::exists(run.folder.string() + ".partial/snapshots.h5");
      }
    }
    if (failed)
      tried[refused ? "by" : "not_judged"].push_back(
          refused
              ? json{{"name", point.at("name")}, {"observable", "the deposit's place"}, {"verdict", "FAIL"}}
              : json{{"name", point.at("name")}, {"why", "a run ended in an error"}});
    else if (!records.empty())
      judge_mutant(point, records, tried);
  }
  tried["killed"] = !tried["by"].empty();
  return tried;
}

}  // namespace

void judge_mutant(const json& point, const std::vector<json>& records, json& mutant) {
  const json changed = mutated(point, converged_among(records));
  const auto rows = judge_truth(changed).rows;
  const std::string unfit = why_unfit(changed.at("runs"));
  if (!unfit.empty()) mutant["not_judged"].push_back({{"name", point.at("name")}, {"why", unfit}});
  for (const auto& row : rows) {
    const auto& observable = row.at("observable");
    const auto found = std::ranges::find_if(
        point.at("truth"), [&](const json& one) { return one.at("observable") == observable; });
    if (found == point.at("truth").end()) continue;
    const json& before = *found;
    const auto& deviation = row.at("deviation");
    const bool judged = observable == "at_rest" || unfit.empty();
    const bool fails = judged && deviation.is_number() && found_out(before, deviation);
    mutant["rows"].push_back({{"name", point.at("name")},
                              {"observable", observable},
                              {"deviation", deviation},
                              {"before", before.at("deviation")},
                              {"verdict", fails ? "FAIL" : before.at("verdict").get<std::string>()}});
    if (fails) {
      mutant["by"].push_back({{"name", point.at("name")}, {"observable", observable}, {"verdict", "FAIL"}});
    }
  }
}

json try_mutants(const Suite& suite, const json& results, const std::filesystem::path& output,
                 const MakingOptions& options) {
  if (suite.mutants.empty()) {
    throw InputError(
        fmt::format("{}: key 'mutants': is missing; name what shall be tried", suite.file.string()));
  }
  const Suite continuum = continuum_of(suite);
  json tried = json::array();
  for (const auto& name : suite.mutants)
    tried.push_back(try_mutant(*find_mutant(name), continuum, results, output, options));
  return tried;
}

std::string mutants_text(const json& mutants) {
  std::string text;
  int survivors = 0;
  for (const auto& mutant : mutants) {
    const bool killed = mutant.at("killed");
    survivors += killed ? 0 : 1;
    std::string by;
    for (const auto& row : mutant.at("by")) {
      by += fmt::format("{}{} {}", by.empty() ? "" : ", ", row.at("name").get<std::string>(),
                        row.at("observable").get<std::string>());
    }
    for (const auto& point : mutant.at("not_judged")) {
      by += fmt::format(" [{} not judged: {}]", point.at("name").get<std::string>(),
                        point.at("why").get<std::string>());
    }
    text += fmt::format("{:<36}{}{}\n", mutant.at("title").get<std::string>(),
                        killed ? "found out by " : "SURVIVES", by);
  }
  return text + fmt::format("{} of {} mutants survive\n", survivors, mutants.size());
}

}  // namespace talus::validation
