#include "validation/gates/truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/statistics/ensemble.h"
#include "validation/backends/backend.h"

namespace talus::validation {
namespace {

using nlohmann::json;

/// Why a run cannot be judged; empty when it can.
std::string unfit(const json& run) {
  const std::string name =
      fmt::format("{} seed {}", run.at("backend").get<std::string>(), run.at("seed").get<std::uint64_t>());
  if (run.at("status") != "ok") return name + " did not finish";
  if (!run.at("observables").at("at_rest").get<bool>()) return name + " is not at rest at its end";
  if (run.at("solver").is_object() && !run["solver"].at("converged").get<bool>())
    return name + " has unconverged solves";
  return {};
}

std::vector<double> values_of(const json& runs, std::span<const std::string_view> backends,
                              const std::string& observable) {
  std::vector<double> values;
  for (const auto& run : runs) {
    if (std::find(backends.begin(), backends.end(), run.at("backend").get<std::string>()) == backends.end())
      continue;
    const auto& value = run.at("status") == "ok" ? run.at("observables").at(observable) : json();
    values.push_back(value.is_number() ? value.get<double>() : std::nan(""));
  }
  return values;
}

json statistics_of(const std::vector<double>& values) {
  if (values.empty()) return nullptr;
  const auto s = analysis::ensemble_statistics(values);
  const auto finite = [](double x) { return std::isfinite(x) ? json(x) : json(); };
  return {{"mean", finite(s.mean)}, {"sd", finite(s.standard_deviation)}, {"n", s.count}};
}

struct Judged {
  Verdict verdict;
  double deviation;  // NaN when it cannot be computed
  std::string why;
};

Judged judge(const std::vector<double>& continuum, const std::vector<double>& reference, double band) {
  if (continuum.empty() || reference.empty())
    return {Verdict::inconclusive, std::nan(""), "a code is missing"};
  const auto model = analysis::ensemble_statistics(continuum),
             truth = analysis::ensemble_statistics(reference);
  const double deviation = (model.mean - truth.mean) / truth.mean;
  if (!std::isfinite(deviation))
    return {Verdict::inconclusive, std::nan(""), "a value is missing or not finite"};
  if (!std::isfinite(truth.standard_deviation))
    return {Verdict::inconclusive, deviation, "one reference run gives no spread"};
  const double uncertainty =
      2.0 * truth.standard_deviation / std::sqrt(static_cast<double>(truth.count)) / std::abs(truth.mean);
  if (std::abs(deviation) > band + uncertainty)
    return {Verdict::fail, deviation, "outside the band by more than the reference's uncertainty"};
  if (uncertainty > band)
    return {Verdict::inconclusive, deviation, "the reference is less certain than the band is wide"};
  if (std::abs(deviation) <= band) return {Verdict::pass, deviation, "within the band"};
  return {Verdict::inconclusive, deviation, "outside the band, by less than the reference's uncertainty"};
}

}  // namespace

std::string verdict_text(Verdict verdict) {
  switch (verdict) {
    case Verdict::pass:
      return "PASS";
    case Verdict::fail:
      return "FAIL";
    case Verdict::inconclusive:
      break;
  }
  return "INCONCLUSIVE";
}

Verdict worse(Verdict a, Verdict b) { return std::max(a, b); }

TruthJudgement judge_truth(std::span<const dem::ObservableBand> bands, const json& runs) {
  std::string reason;
  for (const auto& run : runs) {
    if (reason.empty()) reason = unfit(run);
  }
  constexpr std::array<std::string_view, 1> model{"continuum"};
  TruthJudgement judgement{json::array(), bands.empty() ? Verdict::inconclusive : Verdict::pass};
  for (const auto& band : bands) {
    const auto continuum = values_of(runs, model, band.name);
    const auto reference = values_of(runs, reference_backends, band.name);
    Judged judged = judge(continuum, reference, band.relative_band);
    if (!reason.empty()) judged.verdict = Verdict::inconclusive, judged.why = reason;
    json entry{{"observable", band.name},
               {"unit", band.name == "stop_time" ? "s" : "L0"},
               {"reference", statistics_of(reference)},
               {"deviation", std::isfinite(judged.deviation) ? json(judged.deviation) : json()},
               {"band", band.relative_band},
               {"band_why", band.why},
               {"verdict", verdict_text(judged.verdict)},
               {"why", judged.why}};
    for (const auto backend : backend_names) {
      entry[std::string(backend)] = statistics_of(values_of(runs, std::span(&backend, 1), band.name));
    }
    judgement.summary.push_back(std::move(entry));
    judgement.verdict = worse(judgement.verdict, judged.verdict);
  }
  return judgement;
}

}  // namespace talus::validation
