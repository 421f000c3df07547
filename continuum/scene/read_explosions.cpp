#include "continuum/scene/read_explosions.h"

#include "continuum/scene/read_common.h"

namespace talus {

std::vector<Explosion> read_explosions(const CheckedTable& root) {
  std::vector<Explosion> explosions;
  for (const auto& table : up_to_most_tables(root, "explosion")) {
    explosions.push_back({table.number("time_s", time_range), table.vector("centre_m", coordinate_range),
                          table.number("radius_m", length_range),
                          table.number("speed_m_s", {smallest_positive, velocity_range.high})});
    table.finish();
  }
  return explosions;
}

}  // namespace talus
