#include "validation/backends/balances.h"

#include <vector>

#include "analysis/columns.h"
#include "analysis/snapshot.h"

namespace talus::validation {

Balances read_balances(const std::filesystem::path& budget, double densest_bulk, double gravity) {
  analysis::ColumnsReader reader(budget, {"time_s", "dt_s", "mass_kg", "bulk_volume_m3",
                                          "solids_impulse_z_kg_m_s", "wall_impulse_z_kg_m_s"});
  std::vector<std::vector<double>> rows;  // those with sand
  for (auto row = reader.next_row(); !row.empty(); row = reader.next_row()) {
    if (row[2] > 0.0 && row[3] > 0.0) rows.push_back(std::move(row));
  }
  if (rows.empty()) throw reader.error("no step has sand");
  double weight = 0.0, support = 0.0, mass = 0.0, volume = 0.0;  // times time
  for (const auto& row : rows) {
    const double time = row[0], dt = row[1];
    if (time < 0.9 * rows.back()[0]) continue;
    mass += dt * row[2];
    volume += dt * row[3];
    weight += dt * row[2] * gravity;
    support += row[4] + row[5];
  }
  return {mass / volume / densest_bulk, support / weight};
}

}  // namespace talus::validation
