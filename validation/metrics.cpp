#include "validation/metrics.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/statistics/beverloo.h"
#include "analysis/statistics/fit_error.h"
#include "validation/backends/continuum.h"
#include "validation/gates/values.h"

namespace talus::validation {
namespace {

using nlohmann::json;

/// One code's slots of one material.
struct Slots {
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
    points.push_back({{"opening_m", point.opening}, {"rate_kg_s", point.rate}, {"error_kg_s", point.standard_error}});
  json fit{{"points", points}};
  if (slots.points.size() < 3) return fit;
  try {
    const auto law = analysis::fit_beverloo(slots.points, slots.orifice);
    const auto free = analysis::fit_beverloo_exponent(slots.points, slots.orifice, law.k);
    fit.update({{"C", law.C},
                {"C_error", law.standard_errors[0]},
                {"k", law.k},
                {"k_error", law.standard_errors[1]},
                {"exponent", free.exponent},
                {"exponent_error", free.standard_errors[2]}});
  } catch (const std::exception& error) {  // a fit that fails is told, not hidden
    fit["no_fit"] = error.what();
  }
  return fit;
}

}  // namespace

json suite_metrics(const json&) { return json::array(); }

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
