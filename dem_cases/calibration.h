// Constants of the continuum's material, as measured on the discrete grains.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace talus::dem {

/// mu(I) = mu_1 + (mu_2 - mu_1) / (1 + I_0 / I), I = |shear rate| d sqrt(rho_grain / p) (Jop, Forterre & Pouliquen
/// 2006); d and rho_grain are those of the case's grains. Each uncertainty is one standard error.
struct FrictionLaw {
  double mu_1, mu_1_uncertainty;
  double mu_2, mu_2_uncertainty;  // mu_2 > mu_1
  double I_0, I_0_uncertainty;
};

/// Everything in SI and radians; the file has degrees.
struct MaterialConstants {
  double friction_angle;                      // theta, rad, plane-strain critical state
  double friction_angle_uncertainty;          // rad
  double max_volume_fraction;                 // phi_max, 1
  double max_volume_fraction_uncertainty;     // 1
  std::string status;                         // "provisional" or "calibrated"
  std::string source;                         // how it was measured
  std::optional<FrictionLaw> friction_law{};  // not in files from before the shear cell
};

/// The material called `material_name` of a calibration file. Throws InputError naming file, line, key, value
/// and what is allowed; the whole file is checked, not only the material that is asked for.
MaterialConstants read_calibration(const std::filesystem::path& file, const std::string& material_name);

}  // namespace talus::dem
