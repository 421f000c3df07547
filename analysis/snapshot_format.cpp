#include "analysis/snapshot_format.h"

#include <cmath>

namespace talus::analysis {

SnapshotError snapshot_error(const std::filesystem::path& file, std::string_view what) {
  return SnapshotError(fmt::format("{}: {}", file.string(), what));
}

void check_frame(const std::filesystem::path& file, std::size_t index, const Snapshot& snapshot,
                 double previous) {
  const auto fail = [&](std::string_view what) {
    throw snapshot_error(file, fmt::format("frame {} (t = {} s): {}", index, snapshot.time, what));
  };
  if (!std::isfinite(snapshot.time)) fail("the time is not finite");
  if (index > 0 && snapshot.time <= previous) {
    fail(fmt::format("times must increase, but the frame before has {} s", previous));
  }
  const auto count = snapshot.volumes.size();
  if (snapshot.positions.cols() != count || snapshot.velocities.cols() != count) {
    fail(fmt::format("{} positions, {} velocities and {} volumes", snapshot.positions.cols(),
                     snapshot.velocities.cols(), count));
  }
  if (!snapshot.positions.allFinite()) fail("a position is not finite");
  if (!snapshot.velocities.allFinite()) fail("a velocity is not finite");
  if (!snapshot.volumes.allFinite() || (count > 0 && snapshot.volumes.minCoeff() <= 0.0)) {
    fail("a volume is not positive and finite");
  }
}

std::filesystem::path xdmf_file(const std::filesystem::path& snapshots) {
  auto file = snapshots;
  return file.replace_extension(".xdmf");
}

}  // namespace talus::analysis
