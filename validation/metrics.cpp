#include "validation/metrics.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/statistics/beverloo.h"
#include "analysis/statistics/equivalence.h"
#include "analysis/statistics/model_bias.h"
#include "validation/backends/continuum.h"
#include "validation/corrected.h"
#include "validation/gates/profile_distance.h"
#include "validation/gates/values.h"

namespace talus::validation {
namespace {

using nlohmann::json;

/// One code's slots of one material.
struct Slots {
  double
      edge;  // k that is given where the exponent is fitted: the two cannot be told apart by three openings
  std::vector<analysis::DischargePoint> points;
  analysis::Orifice orifice;
};

/// Mean rate with its standard error: that of the seeds, or of the single fits where there is one seed or they agree by chance.
analysis::DischargePoint discharge_point(double opening, const json& runs, const std::string& code) {
  const auto rate = analysis::ensemble_statistics(values_of(runs, code, "discharge_rate"));
  const auto error = analysis::ensemble_statistics(values_of(runs, code, "discharge_rate_error"));
  const auto count = static_cast<double>(rate.count);
  const double seeds = rate.count > 1 ? rate.standard_deviation / std::sqrt(count) : 0.0;
  return {opening, rate.mean, std::max(seeds, error.mean / std::sqrt(count))};
}

std::map<std::pair<std::string, std::string>, Slots> slots_of(const json& results) {
  std::map<std::pair<std::string, std::string>, Slots> slots;
  for (const auto& point : results.at("points")) {
    if (point.at("kind") != "slot") continue;
    const auto& parameters = point.at("parameters");
    for (const char* code : {continuum_code, "liggghts", "yade"}) {
      if (runs_of(point.at("runs"), code).empty()) continue;
      auto& found = slots[{point.at("calibration").at("name"), code}];
      found.edge = std::string(code) == continuum_code ? 0.0 : edge_width;
      found.orifice = {
          .grain_diameter = parameters.at("grains").at("diameter_m"),
          .bulk_density = parameters.at("protocol").at("volume_fraction").get<double>() *
                          parameters.at("grains").at("density_kg_m3").get<double>(),
          .gravity = parameters.at("protocol").at("gravity_m_s2"),
          .slot_depth = parameters.at("geometry").at("thickness_m").get<double>(),
      };
      found.points.push_back(
          discharge_point(parameters.at("geometry").at("opening_m"), point.at("runs"), code));
    }
  }
  return slots;
}

json fit_json(const Slots& slots) {
  json points = json::array();
  for (const auto& point : slots.points)
    points.push_back(
        {{"opening_m", point.opening}, {"rate_kg_s", point.rate}, {"error_kg_s", point.standard_error}});
  json fit{{"points", points}};
  if (slots.points.size() < 3) return fit;
  try {
    const auto law = analysis::fit_beverloo(slots.points, slots.orifice);
    const auto free = analysis::fit_beverloo_exponent(slots.points, slots.orifice, slots.edge);
    fit.update({{"C", law.C},
                {"C_error", law.standard_errors[0]},
                {"k", law.k},
                {"k_error", law.standard_errors[1]},
                {"exponent_given_k", slots.edge},
                {"exponent", free.exponent},
                {"exponent_error", free.standard_errors[2]}});
  } catch (const std::exception& error) {  // a fit that fails is told, not hidden
    fit["no_fit"] = error.what();
  }
  return fit;
}

/// Continuum over reference, of one observable at all points.
struct Comparisons {
  std::vector<analysis::ModelPair> pairs;
  double band = 0.0;
  double squared_uncertainty = 0.0;  // of the references, summed where known
  int known = 0;
};

json metric(const std::string& observable, const Comparisons& comparisons) {
  const double reference =
      comparisons.known > 0 ? std::sqrt(comparisons.squared_uncertainty / comparisons.known) : 0.0;
  json row{{"observable", observable}, {"n", comparisons.pairs.size()}, {"reference_relative_sd", reference}};
  const auto result = analysis::model_bias(comparisons.pairs, reference);
  if (!result.found) {
    row["why_not"] = result.why_not;
    return row;
  }
  const auto& bias = *result.found;
  row.update({{"bias_factor", bias.bias_factor},
              {"bias_interval", {bias.bias_interval.lower, bias.bias_interval.upper}},
              {"model_relative_sd", bias.model_deviation},
              {"model_relative_sd_interval",
               {bias.model_deviation_interval.lower, bias.model_deviation_interval.upper}}});
  // Of the mean deviation over points, whose scatter is its uncertainty.
  std::vector<double> deviations;
  for (const auto& pair : comparisons.pairs) deviations.push_back(pair.model - 1.0);
  const auto s = analysis::ensemble_statistics(deviations);
  const auto count = static_cast<double>(s.count);
  const auto equivalence = analysis::test_equivalence(s.mean, s.standard_deviation / std::sqrt(count),
                                                      count - 1.0, comparisons.band);
  row["equivalence"] = {
      {"band", comparisons.band}, {"p", equivalence.p}, {"equivalent", equivalence.equivalent}};
  return row;
}

}  // namespace

json suite_metrics(const json& results) {
  std::map<std::string, Comparisons> found;
  for (const auto& point : results.at("points")) {
    for (const auto& row : point.at("truth")) {
      const std::string observable = row.at("observable");
      if (is_distance(observable) || row.value("exact", false) || !row.at("deviation").is_number() ||
          row.at("unfit") == true)
        continue;  // a distance has no bias, and a law is not the discrete codes' to tell
      Comparisons& comparisons = found[observable];
      comparisons.pairs.push_back({1.0 + row.at("deviation").get<double>(), 1.0});
      const double band = row.at("band");
      comparisons.band = comparisons.pairs.size() == 1 ? band : std::min(comparisons.band, band);
      if (const auto& u = row.at("u_reference").at("combined"); u.is_number()) {
        comparisons.squared_uncertainty += u.get<double>() * u.get<double>();
        ++comparisons.known;
      }
    }
  }
  json metrics = json::array();
  for (const auto& [observable, comparisons] : found) metrics.push_back(metric(observable, comparisons));
  return metrics;
}

json beverloo_fits(const json& results) {
  json fits = json::array();
  for (const auto& [name, slots] : slots_of(results)) {
    json fit = fit_json(slots);
    fit["material"] = name.first;
    fit["code"] = name.second;
    fits.push_back(std::move(fit));
  }
  return fits;
}

}  // namespace talus::validation
