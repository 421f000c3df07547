// From the stored runs of the shear cell to calibration.toml, the only source of the continuum's material constants.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "dem_cases/shear_cell/shear_cell.h"

namespace talus::dem {

/// The text of calibration.toml, which read_calibration() takes. Each record is {"point", "code", "version", "seed",
/// "observables"}, the last as measure_simple_shear() and measure_biaxial() give them; records of points that are not
/// the case's are left out. For each material
/// - friction_angle_deg is that of the slowest biaxial point, the mean over the codes, each the mean over its seeds; its
///   uncertainty has the scatter over seeds and half the range over codes;
/// - mu_1, mu_2, I_0 fit mu(I), and max_volume_fraction is phi(I -> 0) of a line in I; both through the points of both
///   tests, each the mean over the LIGGGHTS seeds. Where reduced chi^2 is above 1 its root stretches the uncertainties.
/// Throws InputError when a point of the case has no record, a record lacks something or the law cannot be fitted.
std::string calibrate(const ShearCell& cell, const std::vector<nlohmann::json>& records);

}  // namespace talus::dem
