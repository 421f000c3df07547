#include "dem_cases/shear_cell/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <span>

#include "analysis/statistics/block_average.h"
#include "continuum/files/input_error.h"
#include "dem_cases/shear_cell/samples.h"
#include "dem_cases/shear_cell/schedule.h"

namespace talus::dem {
namespace {

constexpr std::size_t curve_points = 100;  // at most, in a stored curve
constexpr double degrees = 180.0 / std::numbers::pi;

using Columns = std::map<std::string, std::vector<double>>;

double mean(std::span<const double> values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

std::span<const double> after(const std::vector<double>& values, std::size_t first) {
  return std::span(values).subspan(first);
}

template <class Function>
std::vector<double> combined(const std::vector<double>& a, const std::vector<double>& b, Function function) {
  std::vector<double> result(a.size());
  std::transform(a.begin(), a.end(), b.begin(), result.begin(), function);
  return result;
}

/// Means of equal stretches: a curve that hides the noise of single samples and is small enough to be stored.
std::vector<double> thinned(const std::vector<double>& values) {
  const std::size_t stretch = (values.size() + curve_points - 1) / curve_points;
  std::vector<double> result;
  for (std::size_t first = 0; first + stretch <= values.size(); first += stretch)
    result.push_back(mean(std::span(values).subspan(first, stretch)));
  return result;
}

/// Mean of numerator / mean of denominator, with the standard error of that ratio: to first order that of the mean of
/// (numerator - ratio denominator) / mean denominator.
analysis::BlockAverage ratio(std::span<const double> numerator, std::span<const double> denominator) {
  const double below = mean(denominator);
  const double value = mean(numerator) / below;
  std::vector<double> residual(numerator.size());
  for (std::size_t i = 0; i < residual.size(); ++i)
    residual[i] = (numerator[i] - value * denominator[i]) / below;
  analysis::BlockAverage result = analysis::block_average(residual);
  result.mean = value;
  return result;
}

void store(nlohmann::json& observables, const std::string& name, const analysis::BlockAverage& value) {
  observables[name] = value.mean;
  observables[name + "_error"] = value.standard_error;
}

/// Curves of what is left of the noise by thinning; friction is a ratio of means, as in the observables.
nlohmann::json simple_shear_curves(const Columns& columns, double interval) {
  std::vector<double> strain;
  double sum = 0.0;
  for (const double rate : columns.at("shear_rate")) strain.push_back(sum += rate * interval);
  return {{"shear_strain", thinned(strain)},
          {"friction_coefficient", combined(thinned(columns.at("shear_stress")),
                                            thinned(columns.at("normal_stress")), std::divides<>())},
          {"volume_fraction", thinned(columns.at("volume_fraction"))}};
}

nlohmann::json biaxial_curves(const Columns& columns) {
  const auto axial = thinned(columns.at("szz")), lateral = thinned(columns.at("sxx"));
  const auto sine = [](double a, double b) { return (a - b) / (a + b); };
  return {{"axial_strain", thinned(columns.at("axial_strain"))},
          {"sin_friction_angle", combined(axial, lateral, sine)},
          {"volume_fraction", thinned(columns.at("volume_fraction"))}};
}

void require_near(const std::filesystem::path& file, std::string_view what, double value, double wanted,
                  double tolerance) {
  if (!(std::abs(value / wanted - 1.0) <= tolerance)) {
    throw InputError(fmt::format("{}: the {} is {:.6g} on average; the case wants {:.6g} within {:.0f} %",
                                 file.string(), what, value, wanted, 100.0 * tolerance));
  }
}

void require_strain(const ShearCell& cell, const std::filesystem::path& file, double strain) {
  // Half a sample at either end belongs to nothing.
  if (!(strain >= 0.99 * cell.protocol.least_strain)) {
    throw InputError(fmt::format("{}: the shear strain averaged over is {:.3g}; the case wants at least {}",
                                 file.string(), strain, cell.protocol.least_strain));
  }
}

}  // namespace

nlohmann::json measure_simple_shear(const ShearCell& cell, const SimpleShearPoint& point,
                                    Eigen::Index sphere_count, const std::filesystem::path& folder) {
  const auto file = folder / samples_file;
  const ShearProtocol& protocol = cell.protocol;
  Columns columns = read_samples(file, {.columns = simple_shear_columns,
                                        .steps_per_sample = protocol.steps_per_sample,
                                        .step_count = step_count(cell, point),
                                        .sphere_count = sphere_count});
  const double interval = protocol.time_step * protocol.steps_per_sample;
  const auto first =
      static_cast<std::size_t>(point.transient_strain / (wall_shear_rate(cell, point) * interval));
  const auto normal = after(columns["normal_stress"], first), shear = after(columns["shear_stress"], first);
  const auto rate = after(columns["shear_rate"], first);
  const double normal_stress = mean(normal),
               shear_strain = mean(rate) * interval * static_cast<double>(rate.size());
  require_near(file, "normal stress", normal_stress, cell.simple_shear.normal_stress,
               protocol.stress_tolerance);
  require_strain(cell, file, shear_strain);
  analysis::BlockAverage inertial_number = analysis::block_average(rate);
  const double per_rate = inertial_number_of(cell.grains, 1.0, normal_stress);
  inertial_number.mean *= per_rate;
  inertial_number.standard_error *= per_rate;
  require_near(file, "inertial number", inertial_number.mean, point.inertial_number,
               protocol.inertial_tolerance);

  nlohmann::json observables{{"normal_stress", normal_stress}, {"shear_strain", shear_strain}};
  store(observables, "friction_coefficient", ratio(shear, normal));
  store(observables, "volume_fraction", analysis::block_average(after(columns["volume_fraction"], first)));
  store(observables, "inertial_number", inertial_number);
  return {{"observables", observables}, {"curves", simple_shear_curves(columns, interval)}};
}

nlohmann::json measure_biaxial(const ShearCell& cell, const BiaxialPoint& point, Eigen::Index sphere_count,
                               const std::filesystem::path& folder) {
  const auto file = folder / samples_file;
  const Biaxial& biaxial = cell.biaxial;
  Columns columns = read_samples(file, {.columns = biaxial_columns,
                                        .steps_per_sample = cell.protocol.steps_per_sample,
                                        .step_count = step_count(cell, point),
                                        .sphere_count = sphere_count});
  const std::vector<double>& axial_strain = columns["axial_strain"];
  const auto first = static_cast<std::size_t>(
      std::lower_bound(axial_strain.begin(), axial_strain.end(), point.averaged_from) - axial_strain.begin());
  if (first == axial_strain.size()) {
    throw InputError(fmt::format("{}: the axial strain never reaches {}; it ends at {:.4g}", file.string(),
                                 point.averaged_from, axial_strain.back()));
  }
  // Where the volume is constant the lateral strain is minus the axial one, and shear strain is their difference.
  const double shear_strain = 2.0 * (axial_strain.back() - axial_strain[first]);
  require_strain(cell, file, shear_strain);
  const auto difference = combined(columns["szz"], columns["sxx"], std::minus<>());
  const auto sum = combined(columns["szz"], columns["sxx"], std::plus<>());
  const double lateral_stress = mean(after(columns["sxx"], first));
  require_near(file, "lateral stress", lateral_stress, biaxial.lateral_stress,
               cell.protocol.stress_tolerance);
  const double mean_stress = 0.5 * mean(after(sum, first));
  const double duration = cell.protocol.time_step * (columns["step"].back() - columns["step"][first]);
  const double inertial_number = inertial_number_of(cell.grains, shear_strain / duration, mean_stress);
  const double rate_share = inertial_number_of(cell.grains, shear_strain / duration, lateral_stress);
  require_near(file, "inertial number of the lateral stress", rate_share, point.inertial_number,
               cell.protocol.inertial_tolerance);

  const analysis::BlockAverage sine = ratio(after(difference, first), after(sum, first));
  nlohmann::json observables{
      {"lateral_stress", lateral_stress},
      {"shear_strain", shear_strain},
      {"inertial_number", inertial_number},
      {"intermediate_stress_ratio", mean(after(columns["syy"], first)) / mean_stress},
      {"friction_angle_deg", degrees * std::asin(sine.mean)},
      {"friction_angle_deg_error", degrees * sine.standard_error / std::sqrt(1.0 - sine.mean * sine.mean)}};
  store(observables, "sin_friction_angle", sine);
  store(observables, "volume_fraction", analysis::block_average(after(columns["volume_fraction"], first)));
  return {{"observables", observables}, {"curves", biaxial_curves(columns)}};
}

double samples_progress(const std::filesystem::path& folder, double step_count) {
  std::ifstream in(folder / samples_file);
  double step = 0.0;
  std::string line;
  std::getline(in, line);  // the column names
  // A last line that is still being written has no end yet; it counts with the next look.
  while (std::getline(in, line) && !in.eof()) step = std::strtod(line.c_str(), nullptr);
  return std::clamp(step / step_count, 0.0, 1.0);
}

}  // namespace talus::dem
