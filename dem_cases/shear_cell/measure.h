// From the samples that a code wrote of a test to what is known of the material: means with standard errors, and
// curves.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "dem_cases/shear_cell/shear_cell.h"

namespace talus::dem {

/// A line of column names, then one line of numbers after every protocol.steps_per_sample steps of shear. Stresses
/// in Pa, positive in compression.
inline constexpr std::string_view samples_file = "samples.txt";
inline constexpr std::string_view simple_shear_columns =
    "step normal_stress shear_stress volume_fraction shear_rate energy grains";
inline constexpr std::string_view biaxial_columns =
    "step sxx syy szz volume_fraction axial_strain energy grains";

/// Below this share of the wanted stress the packing counts as not yet resisting.
inline constexpr double resisting_share = 0.05;

/// {"observables": {...}, "curves": {...}} over the strain after the transient: friction_coefficient tau / sigma_n,
/// volume_fraction, inertial_number, each with ..._error, the standard error from block averages; normal_stress,
/// shear_strain. Throws InputError when samples are missing or damaged, a grain is lost, or the stress, the inertial
/// number or the strain is not what the case asks for.
nlohmann::json measure_simple_shear(const ShearCell& cell, const SimpleShearPoint& point,
                                    Eigen::Index sphere_count, const std::filesystem::path& folder);

/// The same with sin_friction_angle = (s1 - s3) / (s1 + s3), friction_angle_deg, lateral_stress and
/// intermediate_stress_ratio 2 s2 / (s1 + s3).
nlohmann::json measure_biaxial(const ShearCell& cell, const BiaxialPoint& point, Eigen::Index sphere_count,
                               const std::filesystem::path& folder);

/// The share of `step_count` steps that the samples so far reach, in [0, 1].
double samples_progress(const std::filesystem::path& folder, double step_count);

}  // namespace talus::dem
