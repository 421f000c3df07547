#include "dem_cases/shear_cell/yade_input.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "dem_cases/shear_cell/measure.h"
#include "dem_cases/shear_cell/schedule.h"
#include "dem_cases/yade/rolling.h"

namespace talus::dem {

nlohmann::json yade_biaxial_parameters(const ShearCell& cell, const ShearMaterial& material,
                                       const BiaxialPoint& point, const ShearStart& start) {
  const Biaxial& biaxial = cell.biaxial;
  return {
      {"size_m", {start.size.x(), start.size.y(), start.size.z()}},
      {"diameter_m", cell.grains.diameter},
      {"density_kg_m3", cell.grains.density},
      {"youngs_modulus_pa", cell.grains.youngs_modulus},
      {"poissons_ratio", cell.grains.poissons_ratio},
      {"restitution", cell.restitution},
      {"friction", cell.friction},
      {"rolling_resistance", yade::rolling_resistance(material.rolling_friction)},
      {"rolling_stiffness_n_m",
       yade::rolling_stiffness(cell.grains, material.rolling_friction, biaxial.lateral_stress)},
      {"lateral_stress_pa", biaxial.lateral_stress},
      {"servo_gain_per_s", biaxial.servo_gain},
      {"closing_rate_per_s", biaxial.closing_rate},
      {"resisting_share", resisting_share},
      {"axial_rate_per_s", axial_rate(cell, point)},
      {"time_step_s", cell.protocol.time_step},
      {"compression_steps", steps_for(cell.protocol, cell.protocol.compression_time)},
      {"shear_steps", step_count(cell, point)},
      {"steps_per_sample", cell.protocol.steps_per_sample},
      {"columns", biaxial_columns},
  };
}

std::string yade_packing(const ShearStart& start) {
  std::string text = "# x y z vx vy vz radius, SI units\n";
  for (Eigen::Index i = 0; i < start.count(); ++i) {
    for (const double value : start.positions.col(i)) text += fmt::format("{:.17g} ", value);
    for (const double value : start.velocities.col(i)) text += fmt::format("{:.17g} ", value);
    text += fmt::format("{:.17g}\n", start.radii[i]);
  }
  return text;
}

}  // namespace talus::dem
