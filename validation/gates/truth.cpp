#include "validation/gates/truth.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "analysis/statistics/numerical_uncertainty.h"
#include "analysis/statistics/uncertainty.h"
#include "validation/backends/continuum.h"
#include "validation/gates/budget.h"
#include "validation/gates/profile_distance.h"
#include "validation/gates/values.h"

namespace talus::validation {
namespace {

using nlohmann::json;

constexpr std::array<const char*, 2> discrete_codes{"liggghts", "yade"};

/// Why a run cannot be judged; empty when it can.
std::string unfit(const json& run) {
  const std::string name =
      fmt::format("{} seed {}", run.at("code").get<std::string>(), run.at("seed").get<std::uint64_t>());
  const auto& observables = run.at("observables");
  if (observables.contains("at_rest") && observables.at("at_rest") != true)
    return name + " is not at rest at its end";
  const auto solver = run.find("solver");
  if (solver != run.end() && solver->is_object() && solver->at("converged") != true)
    return name + " has unconverged solves";
  return {};
}

/// What a row is judged by.
struct Comparison {
  double reference;  // in the observable's unit
  double deviation;  // relative
  Budget budget;     // relative
};

bool all_finite(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double x) { return std::isfinite(x); });
}

/// What a single run of another resolution gave; nothing when there is none.
std::optional<double> single_value(const json& runs, const char* code, const std::string& observable) {
  const auto values = values_of(runs, code, observable);
  return values.empty() ? std::nullopt : std::optional(values.front());
}

/// How many steps the run with short ones took for one of the standard run: steps fill frames, so it is not always two.
double step_ratio(const json& runs) {
  const auto steps_of = [&](const char* code) {
    const auto found = runs_of(runs, code);
    if (found.empty() || !found.front()->contains("solver")) return std::nan("");
    const auto& solver = found.front()->at("solver");
    return solver.is_object() ? solver.value("steps", std::nan("")) : std::nan("");
  };
  const double ratio = steps_of(short_steps_code) / steps_of(continuum_code);
  return std::isfinite(ratio) && ratio > 1.0 ? ratio : 2.0;
}

/// Of the discrete codes; or of a law (band's "exact"), which nothing leaves uncertain.
analysis::Uncertainty reference_of(const json& runs, const json& band) {
  const std::string observable = band.at("observable");
  if (band.contains("exact")) {
    return {.codes = {},
            .value = band.at("exact"),
            .seed_deviation = 0.0,
            .seed_degrees_of_freedom = 0,
            .seed_standard = 0.0,
            .code_difference = 0.0,
            .code_standard = 0.0,
            .measurement_standard = 0.0,
            .combined = 0.0};
  }
  std::vector<analysis::CodeValues> codes;
  for (const char* code : discrete_codes) {
    if (auto values = values_of(runs, code, observable); !values.empty()) codes.push_back({code, values});
  }
  return analysis::combine_uncertainty(codes, band.at("measuring"));
}

/// Throws std::invalid_argument for numbers that are not finite.
Comparison compare_values(const json& runs, const json& band) {
  const std::string observable = band.at("observable");
  const auto reference = reference_of(runs, band);
  const auto model = values_of(runs, continuum_code, observable);
  const auto numerical = analysis::numerical_uncertainty({
      .standard = model,
      .coarse = single_value(runs, coarse_code, observable),
      .short_steps = single_value(runs, short_steps_code, observable),
      .step_ratio = step_ratio(runs),
  });
  const double value = reference.value;
  const auto part = [](const std::optional<analysis::NumericalPart>& p) {
    return p ? std::optional(p->standard) : std::nullopt;
  };
  const auto relative = [&](const std::optional<double>& u) {
    return u ? std::optional(*u / std::abs(value)) : std::nullopt;
  };
  return {value,
          analysis::ensemble_statistics(model).mean / value - 1.0,
          {.seeds = relative(reference.seed_standard),
           .codes = relative(reference.code_standard),
           .measuring = relative(reference.measurement_standard),
           .reference = relative(reference.combined),
           .lattice_seeds = relative(numerical.seed_standard),
           .grid = relative(part(numerical.grid)),
           .time_step = relative(part(numerical.time_step)),
           // A budget that lacks a part is none.
           .numerical = numerical.missing.empty() ? relative(numerical.combined) : std::nullopt}};
}

std::vector<Profile> profiles_of(const json& runs, const std::string& code, const std::string& observable) {
  std::vector<Profile> profiles;
  for (const auto* run : runs_of(runs, code)) {
    profiles.push_back(profile_of(*run, observable));
    if (profiles.back().x.empty()) throw std::invalid_argument("a run has no profile or curve");
  }
  return profiles;
}

/// Mean area between each and their mean, as the standard uncertainty of the mean: over sqrt(n). Absent for one.
std::optional<double> scatter(const std::vector<Profile>& profiles) {
  if (profiles.size() < 2) return std::nullopt;
  const Profile mean = mean_profile(profiles);
  double sum = 0.0;
  for (const auto& profile : profiles) sum += area_between(profile, mean);
  const auto count = static_cast<double>(profiles.size());
  // Their mean is nearer to each of them than the truth is: sqrt(n / (n - 1)).
  return sum / count * std::sqrt(count / (count - 1.0)) / std::sqrt(count);
}

/// Of the mean of the codes' means. A code of one run has no scatter of its own: that of the other stands in for it.
std::optional<double> scatter_of_codes(const std::vector<Profile>& a, const std::vector<Profile>& b) {
  const auto of_a = scatter(a), of_b = scatter(b);
  const auto one_run = [](const std::optional<double>& of_mean, const std::vector<Profile>& profiles) {
    return *of_mean * std::sqrt(static_cast<double>(profiles.size()));
  };
  if (!of_a && !of_b) return std::nullopt;
  if (b.empty()) return of_a;
  if (a.empty()) return of_b;
  return 0.5 * std::hypot(of_a ? *of_a : one_run(of_b, b), of_b ? *of_b : one_run(of_a, a));
}

std::optional<double> hypotenuse(std::initializer_list<std::optional<double>> parts) {
  double sum = 0.0;
  for (const auto& part : parts) {
    if (!part) return std::nullopt;
    sum += *part * *part;
  }
  return std::sqrt(sum);
}

/// The distance as the half-width of a rectangular distribution (GUM 4.3.7).
std::optional<double> rectangular(const std::vector<Profile>& a, const std::vector<Profile>& b,
                                  double share) {
  if (a.empty() || b.empty()) return std::nullopt;
  return share * area_between(mean_profile(a), mean_profile(b)) / std::numbers::sqrt3;
}

Comparison compare_profiles(const json& runs, const std::string& observable) {
  const auto of_code = [&](const char* code) { return profiles_of(runs, code, observable); };
  const auto model = of_code(continuum_code), liggghts = of_code("liggghts"), yade = of_code("yade");
  std::vector<Profile> codes;
  for (const auto* profiles : {&liggghts, &yade}) {
    if (!profiles->empty()) codes.push_back(mean_profile(*profiles));
  }
  if (model.empty() || codes.empty()) throw std::invalid_argument("a profile is missing");
  const Profile reference = mean_profile(codes);
  const double whole = area(reference);
  const auto relative = [&](std::optional<double> u) { return u ? std::optional(*u / whole) : std::nullopt; };
  Comparison c{
      .reference = 0.0, .deviation = area_between(mean_profile(model), reference) / whole, .budget = {}};
  Budget& b = c.budget;
  b.seeds = relative(scatter_of_codes(liggghts, yade));
  b.codes = relative(rectangular(liggghts, yade, 0.5));
  b.measuring = 0.0;
  b.reference = b.seeds ? std::optional(std::hypot(*b.seeds, b.codes.value_or(0.0))) : std::nullopt;
  b.lattice_seeds = relative(scatter(model));
  // As numerical_uncertainty.h has it for r = 2: cells against the mean, steps against the run of their own seed.
  b.grid = relative(rectangular(model, of_code(coarse_code), 1.0));
  const double ratio = step_ratio(runs);
  b.time_step = relative(rectangular({model.front()}, of_code(short_steps_code), ratio / (ratio - 1.0)));
  b.numerical = hypotenuse({b.lattice_seeds, b.grid, b.time_step});
  return c;
}

struct Judged {
  Verdict verdict;
  std::string why;
};

Judged judge(const Comparison& c, double band) {
  const double deviation = std::abs(c.deviation);
  if (!std::isfinite(deviation)) return {Verdict::inconclusive, "a value is missing or not finite"};
  if (!c.budget.reference)
    return {Verdict::inconclusive, "the reference's spread is not known: one run a code, or one code alone"};
  if (!c.budget.numerical)
    return {Verdict::inconclusive,
            "the continuum's own uncertainty is not known: it lacks a second seed or the refinement"};
  const double uncertainty = *c.budget.expanded(coverage_factor);
  if (!std::isfinite(uncertainty)) return {Verdict::inconclusive, "an uncertainty is not finite"};
  if (deviation > band + uncertainty) return {Verdict::fail, "outside the band by more than the uncertainty"};
  if (uncertainty > band) {
    const bool numbers = *c.budget.numerical > *c.budget.reference;
    return {Verdict::inconclusive, fmt::format("the uncertainty is larger than the band, most of it the {}",
                                               numbers ? "continuum's own" : "reference's")};
  }
  if (deviation <= band) return {Verdict::pass, "within the band"};
  return {Verdict::inconclusive, "outside the band, by less than the uncertainty"};
}

/// Nothing when there is nothing to compare.
std::optional<Comparison> comparison_of(const json& runs, const json& band) {
  const std::string observable = band.at("observable");
  try {
    if (is_distance(observable)) return compare_profiles(runs, observable);
    if (!all_finite(values_of(runs, continuum_code, observable))) return std::nullopt;
    return compare_values(runs, band);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

/// One code alone tells nothing of the codes' spread.
void borrow_code_spread(const std::string& observable, const std::map<std::string, double>& code_spread,
                        Budget& budget) {
  if (budget.codes) return;
  const auto found = code_spread.find(observable);
  if (found == code_spread.end() || !budget.reference) {
    budget.reference.reset();
    return;
  }
  budget.codes = found->second;
  budget.reference = std::hypot(*budget.reference, found->second);
}

/// Share of the runs of a code that are at rest at their end; nothing where none tells.
std::optional<double> share_at_rest(const json& runs, const std::string& code) {
  int told = 0, resting = 0;
  for (const auto* run : runs_of(runs, code)) {
    const auto found = run->at("observables").find("at_rest");
    if (found == run->at("observables").end()) continue;
    ++told;
    resting += *found == true;
  }
  return told > 0 ? std::optional(static_cast<double>(resting) / told) : std::nullopt;
}

/// The row "at_rest"; nothing for a case that does not come to rest.
std::optional<json> rest_row(const json& runs) {
  const auto model = share_at_rest(runs, continuum_code);
  if (!model) return std::nullopt;
  bool reference_rests = true;  // stored runs that do not tell were refused unless they did
  for (const char* code : discrete_codes) reference_rests &= share_at_rest(runs, code).value_or(1.0) == 1.0;
  const bool known = reference_rests && !(runs_of(runs, "liggghts").empty() && runs_of(runs, "yade").empty());
  const Verdict verdict = !known ? Verdict::inconclusive : *model < 1.0 ? Verdict::fail : Verdict::pass;
  json row{
      {"observable", "at_rest"},
      {"unit", "1"},
      {"reference", 1.0},
      {"deviation", *model - 1.0},
      {"band", 0.0},
      {"band_why", "what rests in the discrete codes must rest in the continuum"},
      {"coverage_factor", coverage_factor},
      {"uncertainty", 0.0},
      {"unfit", false},
      {"exact", true},
      {"continuum", nullptr},
      {"liggghts", nullptr},
      {"yade", nullptr},
      {"verdict", verdict_text(verdict)},
      {"why", verdict == Verdict::pass   ? "at rest at the end"
              : verdict == Verdict::fail ? "still moving at the end, when the discrete codes' deposit rests"
                                         : "a discrete code's deposit is not at rest at the end"}};
  row.update(budget_json({}));
  return row;
}

}  // namespace

std::string why_unfit(const json& runs) {
  for (const auto& run : runs) {
    if (auto reason = unfit(run); !reason.empty()) return reason;
  }
  return {};
}

TruthJudgement judge_truth(const json& point, const std::map<std::string, double>& code_spread) {
  const auto& runs = point.at("runs");
  TruthJudgement judgement{json::array(), Verdict::inconclusive};
  if (runs_of(runs, continuum_code).empty()) return judgement;
  const std::string reason = why_unfit(runs);
  Verdict worst = Verdict::pass;
  for (const auto& band : point.at("bands")) {
    const std::string observable = band.at("observable");
    auto comparison = comparison_of(runs, band);
    if (comparison) borrow_code_spread(observable, code_spread, comparison->budget);
    Judged judged = comparison ? judge(*comparison, band.at("band"))
                               : Judged{Verdict::inconclusive, "a value is missing or not finite"};
    if (!reason.empty()) judged = {Verdict::inconclusive, reason};
    json row{
        {"observable", observable},
        {"unit", band.at("unit")},
        {"reference", comparison ? finite_or_null(comparison->reference) : json()},
        {"deviation", comparison ? finite_or_null(comparison->deviation) : json()},
        {"band", band.at("band")},
        {"band_why", band.at("why")},
        {"coverage_factor", coverage_factor},
        {"uncertainty", or_null(comparison ? comparison->budget.expanded(coverage_factor) : std::nullopt)},
        {"unfit", !reason.empty()},
        {"verdict", verdict_text(judged.verdict)},
        {"why", judged.why}};
    row.update(budget_json(comparison ? comparison->budget : Budget{}));
    row["exact"] = band.contains("exact");
    for (const char* code : {continuum_code, "liggghts", "yade"}) {
      const bool no_number =
          is_distance(observable) || (band.contains("exact") && std::string(code) != continuum_code);
      row[code] = no_number ? json() : statistics_json(values_of(runs, code, observable));
    }
    judgement.rows.push_back(std::move(row));
    worst = worse(worst, judged.verdict);
  }
  if (auto row = rest_row(runs)) {
    worst = worse(worst, verdict_of(row->at("verdict")));
    judgement.rows.push_back(std::move(*row));
  }
  if (!judgement.rows.empty()) judgement.verdict = worst;
  return judgement;
}

}  // namespace talus::validation
