#include "analysis/body_track.h"

#include <fmt/format.h>

#include "analysis/columns.h"
#include "analysis/snapshot.h"

namespace talus::analysis {

BodyTrack read_body_track(const std::filesystem::path& file) {
  ColumnsReader reader(file, {"time_s", "x_m", "y_m", "z_m", "vx_m_s", "vy_m_s", "vz_m_s"});
  BodyTrack track;
  for (auto v = reader.next_row(); !v.empty(); v = reader.next_row()) {
    track.push_back({v[0], {v[1], v[2], v[3]}, {v[4], v[5], v[6]}});
    if (track.size() > 1 && track.back().time <= track[track.size() - 2].time)
      throw reader.error("the time does not increase: a second body, or a damaged file");
  }
  if (track.empty()) throw SnapshotError(fmt::format("{}: holds no row", file.string()));
  return track;
}

}  // namespace talus::analysis
