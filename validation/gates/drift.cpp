#include "validation/gates/drift.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "continuum/files/atomic_file.h"
#include "continuum/files/data_folder.h"
#include "continuum/files/input_error.h"
#include "continuum/files/provenance.h"
#include "validation/backends/continuum.h"
#include "validation/gates/values.h"

namespace talus::validation {
namespace {

using nlohmann::json;

constexpr const char* schema = "talus-baseline";
constexpr int schema_version = 1;

std::filesystem::path baseline_file(const std::filesystem::path& folder, const std::string& suite) {
  // The name comes from a suite's file or from stored results, whoever wrote them.
  if (suite.empty() || suite.front() == '.' || std::filesystem::path(suite).filename() != suite)
    throw InputError(
        fmt::format("the suite's name, '{}', must name a file: no '/', and no '.' at its start", suite));
  return folder / (suite + ".json");
}

std::filesystem::path history_file(const std::filesystem::path& folder) { return folder / "history.jsonl"; }

/// What the case is compared by, as far as the runs have it as a number of their own, and when the flow stopped.
std::vector<std::string> observables_of(const json& point) {
  std::vector<std::string> names;
  const auto runs = runs_of(point.at("runs"), continuum_code);
  if (runs.empty()) return names;
  const auto& observables = runs.front()->at("observables");
  const auto add = [&](const std::string& name) {
    if (observables.contains(name) && observables.at(name).is_number()) names.push_back(name);
  };
  for (const auto& band : point.at("bands")) add(band.at("observable"));
  if (std::ranges::find(names, "stop_time") == names.end()) add("stop_time");
  return names;
}

bool converged(const json& point) {
  return std::ranges::all_of(runs_of(point.at("runs"), continuum_code), [](const json* run) {
    const auto solver = run->find("solver");
    return solver == run->end() || !solver->is_object() || solver->at("converged") == true;
  });
}

json accepted_value(const json& point, const std::string& observable) {
  const auto s = analysis::ensemble_statistics(values_of(point.at("runs"), continuum_code, observable));
  const double scatter = s.count > 1 && s.mean != 0.0
                             ? 2.0 * s.standard_deviation * std::sqrt(2.0 / s.count) / std::abs(s.mean)
                             : 0.0;
  return {{"value", s.mean}, {"tolerance", std::max(smallest_tolerance, scatter)}, {"n", s.count}};
}

json accepted_point(const json& point) {
  const std::string name = point.at("name");
  if (!converged(point))
    throw InputError(fmt::format("{}: a run has unconverged solves; such results cannot be accepted", name));
  json values = json::object();
  for (const auto& observable : observables_of(point)) {
    values[observable] = accepted_value(point, observable);
    if (!std::isfinite(values[observable]["value"].get<double>()))
      throw InputError(
          fmt::format("{}: {} is not finite; such results cannot be accepted", name, observable));
  }
  return values;
}

/// What moves when `now` takes the place of `before`.
json changes(const json& before, const json& now) {
  json list = json::array();
  for (const auto& [name, values] : now.items()) {
    for (const auto& [observable, value] : values.items()) {
      const json old = before.contains(name) && before[name].contains(observable)
                           ? before[name][observable].at("value")
                           : json();
      if (old != value.at("value"))
        list.push_back(
            {{"name", name}, {"observable", observable}, {"old", old}, {"new", value.at("value")}});
    }
  }
  return list;
}

std::string who() {
  const char* user = std::getenv("USER");
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  return fmt::format("{}@{}", user && *user ? user : "unknown", host.data());
}

Verdict verdict_of_change(double change, double tolerance) {
  if (!std::isfinite(change)) return Verdict::inconclusive;
  return std::abs(change) > tolerance ? Verdict::fail : Verdict::pass;
}

/// now / before - 1; absolute where the accepted value is 0.
double relative_change(double now, double before) { return before == 0.0 ? now : now / before - 1.0; }

}  // namespace

std::filesystem::path baseline_folder() { return data_folder("validation/baseline"); }

std::optional<json> read_baseline(const std::filesystem::path& folder, const std::string& suite) {
  const auto file = baseline_file(folder, suite);
  if (!std::filesystem::exists(file)) return std::nullopt;
  try {
    json baseline = json::parse(read_file(file));
    if (!baseline.at("points").is_object() || !baseline.at("accepted").is_object() ||
        baseline.at("schema") != schema || baseline.at("schema_version") != schema_version ||
        baseline.at("suite") != suite)
      throw InputError(fmt::format("{}: not the baseline of {}", file.string(), suite));
    return baseline;
  } catch (const json::exception& error) {
    throw InputError(fmt::format("{}: damaged: {}; take it from git again", file.string(), error.what()));
  }
}

DriftJudgement judge_drift(const json& point, const json& baseline) {
  DriftJudgement judgement{json::array(), Verdict::pass};
  const auto accepted = baseline.at("points").find(point.at("name").get<std::string>());
  const bool known = accepted != baseline.at("points").end();
  auto names = observables_of(point);
  if (known) {  // what was accepted and is gone is a change as well
    for (const auto& [name, value] : accepted->items()) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  const bool fit = converged(point);
  for (const auto& name : names) {
    const auto values = values_of(point.at("runs"), continuum_code, name);
    const double now = values.empty() ? std::nan("") : analysis::ensemble_statistics(values).mean;
    json row{{"observable", name},
             {"now", finite_or_null(now)},
             {"baseline", nullptr},
             {"change", nullptr},
             {"tolerance", nullptr}};
    Verdict verdict = Verdict::inconclusive;
    std::string why = "not in the baseline";
    if (known && accepted->contains(name)) {
      const auto& old = (*accepted)[name];
      const double change = relative_change(now, old.at("value"));
      verdict = fit ? verdict_of_change(change, old.at("tolerance")) : Verdict::inconclusive;
      why = !fit                       ? "a run has unconverged solves"
            : verdict == Verdict::pass ? "within the tolerance"
            : verdict == Verdict::fail ? "moved by more than the tolerance"
                                       : "a value is missing or not finite";
      row.update({{"baseline", old.at("value")},
                  {"change", finite_or_null(change)},
                  {"tolerance", old.at("tolerance")}});
    }
    row["verdict"] = verdict_text(verdict);
    row["why"] = why;
    judgement.rows.push_back(std::move(row));
    judgement.verdict = worse(judgement.verdict, verdict);
  }
  if (judgement.rows.empty()) judgement.verdict = Verdict::inconclusive;
  return judgement;
}

void judge_drift_of_suite(json& results, const std::filesystem::path& folder) {
  const auto baseline = read_baseline(folder, results.at("suite"));
  json& drift = results["drift"];
  drift = {{"verdict", verdict_text(Verdict::inconclusive)}, {"baseline", nullptr}};
  results["history"] = read_history(folder, results.at("suite"));
  for (auto& point : results.at("points")) {
    point["drift"] = json::array();
    point["drift_verdict"] = verdict_text(Verdict::inconclusive);
  }
  if (!baseline) {
    drift["why"] =
        "no results of this suite were accepted yet: 'talus-validate accept' makes them the baseline";
    return;
  }
  drift["baseline"] = baseline->at("accepted");
  Verdict verdict = Verdict::pass;
  std::set<std::string> judged;
  for (auto& point : results.at("points")) {
    if (runs_of(point.at("runs"), continuum_code).empty()) continue;
    const auto judgement = judge_drift(point, *baseline);
    point["drift"] = judgement.rows;
    point["drift_verdict"] = verdict_text(judgement.verdict);
    verdict = worse(verdict, judgement.verdict);
    judged.insert(point.at("name").get<std::string>());
  }
  const bool lacking = std::ranges::any_of(baseline->at("points").items(),
                                           [&](const auto& item) { return !judged.contains(item.key()); });
  if (judged.empty() || lacking) verdict = worse(verdict, Verdict::inconclusive);
  drift["verdict"] = verdict_text(verdict);
  drift["why"] = lacking                    ? "the baseline holds points that were not run"
                 : verdict == Verdict::pass ? "nothing moved"
                 : verdict == Verdict::fail ? "something moved by more than its tolerance"
                                            : "something could not be judged";
}

json accept(const json& results, const std::string& reason, const std::filesystem::path& folder) {
  if (reason.find_first_not_of(" \t\n") == std::string::npos)
    throw InputError("--reason is empty; say why these results take the baseline's place");
  const std::string suite = results.at("suite");
  const auto old = read_baseline(folder, suite);
  const json old_points = old ? old->at("points") : json::object();
  // A part of a suite moves its own points only; a whole one drops those that it no longer has.
  json points = results.value("tag", "").empty() ? json::object() : old_points;
  const json& before = old_points;
  for (const auto& point : results.at("points")) {
    if (!runs_of(point.at("runs"), continuum_code).empty())
      points[point.at("name").get<std::string>()] = accepted_point(point);
  }
  if (points.empty()) throw InputError("there is no continuum run to accept");
  const auto& made = results.at("provenance");
  const json accepted{{"when", provenance().at("time_utc")},
                      {"who", who()},
                      {"why", reason},
                      {"git_hash", made.value("git_hash", "")},
                      {"git_dirty", made.value("git_dirty", false)}};
  json entry = accepted;
  entry["suite"] = suite;
  entry["changes"] = changes(before, points);
  make_writable_folder(folder);
  const auto log = history_file(folder);
  const std::string history = std::filesystem::exists(log) ? read_file(log) : std::string();
  const json baseline{{"schema", schema},
                      {"schema_version", schema_version},
                      {"suite", suite},
                      {"accepted", accepted},
                      {"points", points}};
  write_file_atomically(log, history + entry.dump() + "\n");
  write_file_atomically(baseline_file(folder, suite), baseline.dump(1) + "\n");
  return entry;
}

json read_history(const std::filesystem::path& folder, const std::string& suite) {
  json history = json::array();
  const auto file = history_file(folder);
  if (!std::filesystem::exists(file)) return history;
  std::istringstream lines(read_file(file));
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.empty()) continue;
    try {
      json entry = json::parse(line);
      if (entry.at("suite") == suite) history.push_back(std::move(entry));
    } catch (const json::exception& error) {
      throw InputError(
          fmt::format("{}:{}: damaged: {}; take it from git again", file.string(), number, error.what()));
    }
  }
  return history;
}

}  // namespace talus::validation
