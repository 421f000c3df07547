// The track of a rigid body among the items of a run: all that the ruler may know of it, whichever code made it.
//
// It is a file of comma-separated values beside the snapshots, a row for each moment, with the names of the columns in its first
// line. Read are time_s, the centre of mass x_m, y_m, z_m, and its velocity vx_m_s, vy_m_s, vz_m_s, in any order; other columns may
// stand there, such as the orientation and the forces that `talus run` adds.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

namespace talus::analysis {

/// Its name, in the folder of a run.
inline constexpr const char* body_track_file = "bodies.csv";

struct BodyMoment {
  double time;               // s, from the release
  Eigen::Vector3d position;  // m
  Eigen::Vector3d velocity;  // m/s
};

/// Times increase.
using BodyTrack = std::vector<BodyMoment>;

/// Reads the track of the one body of a run. Throws SnapshotError naming file and line: a missing file or column, a cell that is
/// not a finite number, a time that does not increase (as with rows of a second body), no rows.
BodyTrack read_body_track(const std::filesystem::path& file);

}  // namespace talus::analysis
