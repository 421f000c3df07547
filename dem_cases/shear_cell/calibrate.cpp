#include "dem_cases/shear_cell/calibrate.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "analysis/statistics/ensemble.h"
#include "analysis/statistics/fit_error.h"
#include "analysis/statistics/mu_of_i.h"
#include "continuum/files/input_error.h"

namespace talus::dem {
namespace {

using nlohmann::json;
using Records = std::vector<const json*>;

struct Estimate {
  double mean;
  double standard_error;
};

struct RatePoints {
  std::vector<analysis::ShearPoint> friction, volume_fraction;
};

struct RateFit {
  analysis::FrictionLawFit friction;
  analysis::VolumeFractionFit volume_fraction;
};

InputError error(const ShearCell& cell, const std::string& what) {
  return InputError(fmt::format("{}: cannot be calibrated: {}", cell.file.string(), what));
}

/// A member of a record or of its observables, of the type asked for.
template <class Value>
Value member(const ShearCell& cell, const json& record, const char* key) {
  try {
    return record.at(key).get<Value>();
  } catch (const json::exception& problem) {
    throw error(cell, fmt::format("a stored record lacks '{}' or has it wrong ({})", key, problem.what()));
  }
}

Records records_of(const ShearCell& cell, const std::vector<json>& records, const std::string& point) {
  Records found;
  for (const json& record : records) {
    if (member<std::string>(cell, record, "point") == point) found.push_back(&record);
  }
  if (found.empty())
    throw error(cell, fmt::format("there is no stored run of point '{}'; generate it first", point));
  return found;
}

double observable(const ShearCell& cell, const json& record, const std::string& name) {
  const auto observables = member<json>(cell, record, "observables");
  const auto value = member<double>(cell, observables, name.c_str());
  if (!std::isfinite(value)) throw error(cell, fmt::format("a stored {} is not finite", name));
  return value;
}

Records runs_of_code(const ShearCell& cell, const Records& records, const std::string& code) {
  Records found;
  for (const json* record : records) {
    if (member<std::string>(cell, *record, "code") == code) found.push_back(record);
  }
  if (found.empty()) throw error(cell, fmt::format("there is no stored run of {}; generate it first", code));
  return found;
}

double mean_of(const ShearCell& cell, const Records& records, const std::string& name) {
  double sum = 0.0;
  for (const json* record : records) sum += observable(cell, *record, name);
  return sum / static_cast<double>(records.size());
}

/// Mean over runs. Their scatter tells its standard error, but of two or three runs badly: it may be small by chance,
/// so the errors that the runs themselves have from block averages are a lower bound.
Estimate mean_over_runs(const ShearCell& cell, const Records& records, const std::string& name) {
  std::vector<double> values;
  double own = 0.0;
  for (const json* record : records) {
    values.push_back(observable(cell, *record, name));
    own += std::pow(observable(cell, *record, name + "_error"), 2);
  }
  const auto count = static_cast<double>(values.size());
  const auto statistics = analysis::ensemble_statistics(values);
  const double from_runs = std::sqrt(own) / count;
  const double from_scatter =
      values.size() > 1 ? statistics.standard_deviation / std::sqrt(count) : from_runs;
  return {statistics.mean, std::max(from_runs, from_scatter)};
}

/// Mean of the codes' means, with the scatter over seeds and half the range over codes.
Estimate mean_over_codes(const ShearCell& cell, const Records& records, const std::string& name) {
  std::map<std::string, Records> by_code;
  for (const json* record : records) by_code[member<std::string>(cell, *record, "code")].push_back(record);
  double sum = 0.0, variance = 0.0, lowest = INFINITY, highest = -INFINITY;
  for (const auto& [code, runs] : by_code) {
    const Estimate estimate = mean_over_runs(cell, runs, name);
    sum += estimate.mean;
    variance += estimate.standard_error * estimate.standard_error;
    lowest = std::min(lowest, estimate.mean);
    highest = std::max(highest, estimate.mean);
  }
  const auto count = static_cast<double>(by_code.size());
  return {sum / count, std::hypot(std::sqrt(variance) / count, 0.5 * (highest - lowest))};
}

/// Points of one test, each the mean over its LIGGGHTS seeds, appended to those of the other.
template <class Point>
void add_points(const ShearCell& cell, const ShearMaterial& material, const std::vector<json>& records,
                const std::vector<Point>& points, const std::string& friction_name, RatePoints& found) {
  for (const Point& point : points) {
    const Records runs =
        runs_of_code(cell, records_of(cell, records, point_name(material, point)), "liggghts");
    const double inertial_number = mean_of(cell, runs, "inertial_number");
    const auto add = [&](const std::string& name, std::vector<analysis::ShearPoint>& into) {
      const Estimate value = mean_over_runs(cell, runs, name);
      into.push_back({inertial_number, value.mean, value.standard_error});
    };
    add(friction_name, found.friction);
    add("volume_fraction", found.volume_fraction);
  }
}

/// In the biaxial test sin(theta) is the ratio of the largest shear stress to the mean stress, which in simple shear
/// is tau / sigma_n: principal axes of stress and strain rate coincide, and normal stresses hardly differ.
RateFit fit_rate_laws(const ShearCell& cell, const ShearMaterial& material,
                      const std::vector<json>& records) {
  RatePoints points;
  add_points(cell, material, records, cell.biaxial.points, "sin_friction_angle", points);
  add_points(cell, material, records, cell.simple_shear.points, "friction_coefficient", points);
  try {
    return {analysis::fit_friction_law(points.friction),
            analysis::fit_volume_fraction(points.volume_fraction)};
  } catch (const analysis::FitError& problem) {
    throw error(cell, fmt::format("material '{}': {}", material.name, problem.what()));
  }
}

/// "liggghts 3.8.0 (3 runs), yade 2023.02a (1 run)"
std::string codes_text(const ShearCell& cell, const Records& records) {
  std::map<std::string, int> runs;
  for (const json* record : records) {
    ++runs[fmt::format("{} {}", member<std::string>(cell, *record, "code"),
                       member<std::string>(cell, *record, "version"))];
  }
  std::vector<std::string> texts;
  for (const auto& [code, count] : runs)
    texts.push_back(fmt::format("{} ({} {})", code, count, count == 1 ? "run" : "runs"));
  return fmt::format("{}", fmt::join(texts, ", "));
}

/// All records of a material's points of one test.
template <class Point>
Records all_records(const ShearCell& cell, const ShearMaterial& material, const std::vector<json>& records,
                    const std::vector<Point>& points) {
  Records all;
  for (const Point& point : points) {
    const Records runs = records_of(cell, records, point_name(material, point));
    all.insert(all.end(), runs.begin(), runs.end());
  }
  return all;
}

std::string source_text(const ShearCell& cell, const ShearMaterial& material,
                        const std::vector<json>& records, const RateFit& fit) {
  const Records critical = records_of(cell, records, point_name(material, cell.biaxial.points.front()));
  const Records biaxial = all_records(cell, material, records, cell.biaxial.points);
  const Records shear = all_records(cell, material, records, cell.simple_shear.points);
  const Estimate volume_fraction = mean_over_codes(cell, critical, "volume_fraction");
  return fmt::format(
      "friction angle: plane-strain biaxial critical state at I = {:.2g}, {}, volume fraction {:.4f} +- "
      "{:.4f} there; "
      "mu_1, mu_2, I_0 and max_volume_fraction: {} grains in biaxial compression at {} Pa and {} rates, {}; "
      "{} grains in "
      "simple shear at {} Pa and {} rates, {}; reduced chi^2 of mu(I) {:.2g}, of phi = phi_max - {:.3g} I "
      "{:.2g}",
      mean_of(cell, critical, "inertial_number"), codes_text(cell, critical), volume_fraction.mean,
      volume_fraction.standard_error, cell.biaxial.lattice.prod(), cell.biaxial.lateral_stress,
      cell.biaxial.points.size(), codes_text(cell, biaxial), cell.simple_shear.lattice.prod(),
      cell.simple_shear.normal_stress, cell.simple_shear.points.size(), codes_text(cell, shear),
      fit.friction.reduced_chi_squared, fit.volume_fraction.b, fit.volume_fraction.reduced_chi_squared);
}

/// What standard errors grow by where the law misses its points by more than these' own errors: then it is the law, or
/// the difference between the tests, that is uncertain.
double misfit(double reduced_chi_squared) { return std::max(1.0, std::sqrt(reduced_chi_squared)); }

std::string material_text(const ShearCell& cell, const ShearMaterial& material,
                          const std::vector<json>& records) {
  const RateFit fit = fit_rate_laws(cell, material, records);
  const Estimate angle =
      mean_over_codes(cell, records_of(cell, records, point_name(material, cell.biaxial.points.front())),
                      "friction_angle_deg");
  std::string text = fmt::format("\n[{}]\n", material.name);
  const auto add = [&](std::string_view key, std::string_view unit, double value, double uncertainty) {
    text += fmt::format("{0}{1} = {2:.6g}\n{0}_uncertainty{1} = {3:.2g}\n", key, unit, value, uncertainty);
  };
  add("friction_angle", "_deg", angle.mean, angle.standard_error);
  const Eigen::Vector3d errors = misfit(fit.friction.reduced_chi_squared) * fit.friction.standard_errors;
  add("max_volume_fraction", "", fit.volume_fraction.phi_c,
      misfit(fit.volume_fraction.reduced_chi_squared) * fit.volume_fraction.standard_errors[0]);
  add("mu_1", "", fit.friction.mu_1, errors[0]);
  add("mu_2", "", fit.friction.mu_2, errors[1]);
  add("I_0", "", fit.friction.I_0, errors[2]);
  text +=
      fmt::format("status = \"calibrated\"\nsource = \"{}\"\n", source_text(cell, material, records, fit));
  return text;
}

}  // namespace

std::string calibrate(const ShearCell& cell, const std::vector<json>& records) {
  std::string text =
      "# Material constants for the continuum, measured on the discrete grains; written by talus from the "
      "stored runs of the\n"
      "# shear cell. One table per material; cases name it. What and why: README.md beside this file.\n"
      "schema = 1\n";
  for (const ShearMaterial& material : cell.materials) text += material_text(cell, material, records);
  return text;
}

}  // namespace talus::dem
