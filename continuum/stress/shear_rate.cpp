#include "continuum/stress/shear_rate.h"

namespace talus {

Field shear_rate(const ActiveRegion& region, const Field& velocity, const BodyCoupling& bodies,
                 const Field& speeds) {
  StressField strain = make_stress_field(region);
  stress_divergence_transpose(region, velocity, strain);  // -h e_aa in cells, -2 h e_bc on edges
  bodies.add_strain(speeds, strain);
  Field rate = Field::Zero(region.cell_count() + 1);
  for (int cell = 0; cell < region.cell_count(); ++cell) {
    const Eigen::Array3d diagonal = strain.diagonal.col(cell);
    double squared = (diagonal - diagonal.mean()).square().sum();
    const auto& edges = region.cell_edges[static_cast<std::size_t>(cell)];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double sum = 0.0;
      int count = 0;
      for (std::size_t corner = 0; corner < 4; ++corner) {
        const int edge = edges[4 * axis + corner];
        if (edge == region.null_edge()) continue;
        sum += strain.shear[edge];
        ++count;
      }
      if (count > 0) squared += 2.0 * std::pow(0.5 * sum / count, 2);
    }
    rate[cell] = std::sqrt(2.0 * squared) / region.grid.spacing;
  }
  return rate;
}

}  // namespace talus
