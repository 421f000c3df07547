// Constants of the continuum's material, as measured on the discrete grains.
#pragma once

#include <filesystem>
#include <string>

namespace talus::dem {

/// Everything in SI and radians; the file has degrees.
struct MaterialConstants {
  double friction_angle;                   // theta, rad, plane-strain critical state
  double friction_angle_uncertainty;       // rad
  double max_volume_fraction;              // phi_max, 1
  double max_volume_fraction_uncertainty;  // 1
  std::string status;                      // "provisional" or "calibrated"
  std::string source;                      // how it was measured
};

/// The material called `material_name` of a calibration file. Throws InputError naming file, line, key, value
/// and what is allowed; the whole file is checked, not only the material that is asked for.
MaterialConstants read_calibration(const std::filesystem::path& file, const std::string& material_name);

}  // namespace talus::dem
