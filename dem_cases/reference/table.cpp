#include "dem_cases/reference/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "analysis/statistics/beverloo.h"
#include "analysis/statistics/ensemble.h"
#include "analysis/statistics/fit_error.h"
#include "analysis/statistics/uncertainty.h"
#include "dem_cases/case.h"
#include "dem_cases/reference/store.h"

namespace talus::dem {
namespace {

using nlohmann::json;

/// Values by observable and code.
using Values = std::map<std::string, std::map<std::string, std::vector<double>>>;

Values values_of(const std::vector<json>& records) {
  Values values;
  for (const json& record : records) {
    for (const auto& [name, value] : record.at("observables").items()) {
      if (value.is_number()) values[name][record.at("code")].push_back(value.get<double>());
    }
  }
  return values;
}

std::string cell(const std::vector<double>* values) {
  if (!values) return "";
  const auto statistics = analysis::ensemble_statistics(*values);
  return statistics.count > 1 ? fmt::format("{:.4g} +- {:.2g} ({})", statistics.mean,
                                            statistics.standard_deviation, statistics.count)
                              : fmt::format("{:.4g} (1)", statistics.mean);
}

/// Value and combined standard uncertainty over codes and seeds. What the measuring adds is in the figure called NAME_error,
/// where the ruler gives one.
std::string combined(const Values& values, const std::string& name) {
  std::vector<analysis::CodeValues> codes;
  for (const auto& [code, members] : values.at(name)) codes.push_back({code, members});
  double measuring = 0.0;
  for (const char* suffix : {"_error", "_fit_error"}) {
    const auto found = values.find(name + suffix);
    if (found == values.end()) continue;
    for (const auto& [code, members] : found->second)
      measuring = std::max(measuring, analysis::ensemble_statistics(members).mean);
  }
  const auto uncertainty = analysis::combine_uncertainty(codes, measuring);
  return uncertainty.combined ? fmt::format("{:.4g} +- {:.2g}", uncertainty.value, *uncertainty.combined)
                              : fmt::format("{:.4g}", uncertainty.value);
}

std::string difference(const std::vector<double>* a, const std::vector<double>* b) {
  if (!a || !b) return "";
  const double mean_a = analysis::ensemble_statistics(*a).mean,
               mean_b = analysis::ensemble_statistics(*b).mean;
  return mean_a != 0.0 ? fmt::format("{:+.1f} %", 100.0 * (mean_b / mean_a - 1.0)) : std::string();
}

/// C and k of the law of Beverloo for the slots of one material, from all openings that LIGGGHTS has run.
std::string beverloo_row(const std::filesystem::path& reference, const std::vector<Case>& points,
                         const std::string& material) {
  std::vector<analysis::DischargePoint> fitted;
  const Case* last = nullptr;
  for (const Case& point : points) {
    if (point.calibration != material) continue;
    const Values values = values_of(read_records(reference, point.name, point.point));
    if (!values.contains("discharge_rate") || !values.at("discharge_rate").contains("liggghts")) continue;
    const auto& rates = values.at("discharge_rate").at("liggghts");
    const auto statistics = analysis::ensemble_statistics(rates);
    if (statistics.count < 2) continue;
    last = &point;
    fitted.push_back({std::get<SlotGeometry>(point.geometry).opening, statistics.mean,
                      statistics.standard_deviation / std::sqrt(static_cast<double>(statistics.count))});
  }
  if (!last || fitted.size() < 3)
    return fmt::format("| {} | {} of 3 openings stored | | | |\n", material, fitted.size());
  const analysis::Orifice orifice{.grain_diameter = last->grains.diameter,
                                  .bulk_density = last->protocol.volume_fraction * last->grains.density,
                                  .gravity = last->protocol.gravity,
                                  .slot_depth = std::get<SlotGeometry>(last->geometry).thickness};
  try {
    const auto fit = analysis::fit_beverloo(fitted, orifice);
    const auto free = analysis::fit_beverloo_exponent(fitted, orifice, fit.k);
    return fmt::format("| {} | {:.3f} +- {:.3f} | {:.2f} +- {:.2f} | {:.2g} | {:.2f} +- {:.2f} |\n", material,
                       fit.C, fit.standard_errors[0], fit.k, fit.standard_errors[1], fit.reduced_chi_squared,
                       free.exponent, free.standard_errors[2]);
  } catch (const analysis::FitError& error) {
    return fmt::format("| {} | no fit: {} | | | |\n", material, error.what());
  }
}

std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::exists(folder)) return files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::string reference_table(const std::filesystem::path& reference) {
  std::string text =
      "| case | point | observable | LIGGGHTS | YADE | YADE against LIGGGHTS | reference |\n"
      "|---|---|---|---|---|---|---|\n";
  std::map<std::string, double> cpu;
  std::map<std::string, int> count;
  for (const auto& file : files_below(reference)) {
    const std::string case_name = file.parent_path().filename(), point = file.stem();
    const auto records = read_records(reference, case_name, point);
    for (const json& record : records) {
      cpu[record.at("code")] += record.at("cpu_s").get<double>();
      ++count[record.at("code")];
    }
    const Values values = values_of(records);
    for (const auto& [name, by_code] : values) {
      const auto of = [&, &codes = by_code](const char* code) {
        const auto found = codes.find(code);
        return found == codes.end() ? nullptr : &found->second;
      };
      text +=
          fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", case_name, point, name, cell(of("liggghts")),
                      cell(of("yade")), difference(of("liggghts"), of("yade")), combined(values, name));
    }
  }
  for (const auto& [code, seconds] : cpu)
    text += fmt::format("\n{}: {} runs, {:.0f} CPU-s\n", code, count[code], seconds);
  return text;
}

std::string beverloo_table(const std::filesystem::path& reference, const std::filesystem::path& slot_case) {
  const auto points = read_case_points(slot_case);
  std::string text = "| material | C | k | reduced chi^2 | exponent at this k |\n|---|---|---|---|---|\n";
  std::set<std::string> materials;
  for (const Case& point : points) materials.insert(point.calibration);
  for (const auto& material : materials) text += beverloo_row(reference, points, material);
  return text;
}

}  // namespace talus::dem
