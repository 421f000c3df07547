#include "validation/corrected.h"

#include <cmath>
#include <numbers>
#include <optional>

#include "analysis/statistics/beverloo.h"
#include "validation/backends/continuum_scene.h"

namespace talus::validation {
namespace {

/// Nothing for a case that does not drain.
std::optional<analysis::Orifice> orifice_of(const dem::Case& a_case) {
  const bool slot = a_case.kind == "slot";
  if (!slot && a_case.kind != "hourglass") return std::nullopt;
  analysis::Orifice orifice{.grain_diameter = a_case.grains.diameter,
                            .bulk_density = a_case.protocol.volume_fraction * a_case.grains.density,
                            .gravity = a_case.protocol.gravity};
  if (slot) orifice.slot_depth = dem::periodic_thickness(a_case.geometry);
  return orifice;
}

}  // namespace

void add_beverloo_C(const dem::Case& a_case, nlohmann::json& run) {
  const auto orifice = orifice_of(a_case);
  if (!orifice) return;
  const bool grains = run.at("code") == "liggghts" || run.at("code") == "yade";
  auto& observables = run.at("observables");
  const double law = analysis::beverloo_rate(cell_length(a_case), *orifice, 1.0, grains ? edge_width : 0.0);
  const auto rate = observables.find("discharge_rate");
  if (rate != observables.end() && rate->is_number() && law > 0.0)
    observables["beverloo_C"] = rate->get<double>() / law;
  const auto error = observables.find("discharge_rate_error");
  if (error != observables.end() && error->is_number() && law > 0.0)
    observables["beverloo_C_error"] = error->get<double>() / law;
}

double edge_width_effect(const dem::Case& a_case) {
  const auto orifice = orifice_of(a_case);
  if (!orifice) return 0.0;
  const double exponent = orifice->slot_depth ? 1.5 : 2.5;
  const double d = orifice->grain_diameter, open = cell_length(a_case) - edge_width * d;
  return exponent * d * edge_width_uncertainty / open / std::numbers::sqrt3;
}

}  // namespace talus::validation
