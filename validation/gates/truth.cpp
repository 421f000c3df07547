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

std::string first_unfit(const json& runs) {
  for (const auto& run : runs) {
    if (auto reason = unfit(run); !reason.empty()) return reason;
  }
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

/// Throws std::invalid_argument for numbers that are not finite.
Comparison compare_values(const json& runs, const json& band) {
  const std::string observable = band.at("observable");
  std::vector<analysis::CodeValues> codes;
  for (const char* code : discrete_codes) {
    if (auto values = values_of(runs, code, observable); !values.empty()) codes.push_back({code, values});
  }
  const auto reference = analysis::combine_uncertainty(codes, band.at("measuring"));
  const auto model = values_of(runs, continuum_code, observable);
  const auto numerical = analysis::numerical_uncertainty({
      .standard = model,
      .coarse = single_value(runs, coarse_code, observable),
      .short_steps = single_value(runs, short_steps_code, observable),
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

std::vector<Profile> profiles_of(const json& runs, const std::string& code) {
  std::vector<Profile> profiles;
  for (const auto* run : runs_of(runs, code)) {
    if (auto profile = profile_of(*run); !profile.x.empty()) profiles.push_back(std::move(profile));
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

Comparison compare_profiles(const json& runs) {
  const auto model = profiles_of(runs, continuum_code), liggghts = profiles_of(runs, "liggghts"),
             yade = profiles_of(runs, "yade");
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
  // Of the mean of the codes' means; a code of one run has no scatter of its own.
  const auto scatter_l = scatter(liggghts), scatter_y = scatter(yade);
  if (scatter_l || scatter_y) {
    const double one = scatter_l ? *scatter_l : *scatter_y * std::sqrt(yade.size());
    const double other = yade.empty() ? 0.0 : scatter_y ? *scatter_y : one * std::sqrt(liggghts.size());
    b.seeds = relative(std::hypot(one, other) / static_cast<double>(codes.size()));
  }
  b.codes = relative(rectangular(liggghts, yade, 0.5));
  b.measuring = 0.0;
  b.reference = b.seeds ? std::optional(std::hypot(*b.seeds, b.codes.value_or(0.0))) : std::nullopt;
  b.lattice_seeds = relative(scatter(model));
  // As numerical_uncertainty.h has it for r = 2: cells against the mean, steps against the run of their own seed, twice.
  b.grid = relative(rectangular(model, profiles_of(runs, coarse_code), 1.0));
  b.time_step = relative(rectangular({model.front()}, profiles_of(runs, short_steps_code), 2.0));
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
    return {Verdict::inconclusive, "no code has two reference runs, so the reference's spread is not known"};
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
    if (observable == "profile_L1") return compare_profiles(runs);
    if (!all_finite(values_of(runs, continuum_code, observable))) return std::nullopt;
    return compare_values(runs, band);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

}  // namespace

TruthJudgement judge_truth(const json& point) {
  const auto& runs = point.at("runs");
  TruthJudgement judgement{json::array(), Verdict::inconclusive};
  if (runs_of(runs, continuum_code).empty()) return judgement;
  const std::string reason = first_unfit(runs);
  Verdict worst = Verdict::pass;
  for (const auto& band : point.at("bands")) {
    const auto comparison = comparison_of(runs, band);
    Judged judged = comparison ? judge(*comparison, band.at("band"))
                               : Judged{Verdict::inconclusive, "a value is missing or not finite"};
    if (!reason.empty()) judged = {Verdict::inconclusive, reason};
    const std::string observable = band.at("observable");
    json row{
        {"observable", observable},
        {"unit", band.at("unit")},
        {"reference", comparison ? finite_or_null(comparison->reference) : json()},
        {"deviation", comparison ? finite_or_null(comparison->deviation) : json()},
        {"band", band.at("band")},
        {"band_why", band.at("why")},
        {"coverage_factor", coverage_factor},
        {"uncertainty", or_null(comparison ? comparison->budget.expanded(coverage_factor) : std::nullopt)},
        {"verdict", verdict_text(judged.verdict)},
        {"why", judged.why}};
    row.update(budget_json(comparison ? comparison->budget : Budget{}));
    for (const char* code : {continuum_code, "liggghts", "yade"})
      row[code] = observable == "profile_L1" ? json() : statistics_json(values_of(runs, code, observable));
    judgement.rows.push_back(std::move(row));
    worst = worse(worst, judged.verdict);
  }
  if (!judgement.rows.empty()) judgement.verdict = worst;
  return judgement;
}

}  // namespace talus::validation
