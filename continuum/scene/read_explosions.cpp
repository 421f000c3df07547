#include "continuum/scene/read_explosions.h"

namespace talus {

std::vector<Explosion> read_explosions(const CheckedTable& root) {
  std::vector<Explosion> explosions;
  if (!root.has("explosion")) return explosions;
  for (const auto& table : root.tables("explosion")) {
    explosions.push_back({table.number("time_s", positive), table.vector("centre_m"),
                          table.number("radius_m", positive), table.number("speed_m_s", positive)});
    table.finish();
  }
  return explosions;
}

}  // namespace talus
