// The neutral snapshot: all that the ruler may know of a run, whichever code made it.
//
// A run is a time series of snapshots in one HDF5 file, `snapshots.h5`, with an XDMF description beside it so
// that ParaView opens it with real time stamps. The file is written under another name and renamed when the
// series is whole, so a file of that name is never half a run.
//
//   /                    attributes: format = "talus-snapshots", version = 1, made_by, frames, complete = 1
//   /frame_000000        attribute: time (s)
//     positions (n, 3)   velocities (n, 3)   volumes (n)      float64, shuffled and lightly deflated
//
// The number of items n may differ from frame to frame (grains leave, particles split).
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace talus::analysis {

/// Positions and velocities are stored as the columns of 3 x n matrices.
using Vectors = Eigen::Matrix3Xd;

/// One moment. `volumes` are solid volumes: a grain's own volume, a particle's mass over its grain density.
struct Snapshot {
  double time = 0.0;        // s, from the moment the gate opens
  Vectors positions;        // m, 3 x n
  Vectors velocities;       // m/s, 3 x n
  Eigen::VectorXd volumes;  // m^3, n
};

using SnapshotSeries = std::vector<Snapshot>;

/// A snapshot file that is missing, foreign, damaged or not finite.
class SnapshotError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Writes snapshots one at a time; nothing stands under the final name until finish() has returned.
class SnapshotWriter {
 public:
  /// `made_by` is free text (JSON by custom) that says what made the file.
  SnapshotWriter(std::filesystem::path file, std::string_view made_by);
  ~SnapshotWriter();  // removes the unfinished file
  SnapshotWriter(const SnapshotWriter&) = delete;
  SnapshotWriter& operator=(const SnapshotWriter&) = delete;

  /// Times must increase; sizes must agree; every number must be finite and every volume positive.
  /// Throws SnapshotError; what was refused is not written.
  void append(const Snapshot& snapshot);
  /// Closes the file, flushes it to the disk, and puts it and its XDMF in place. Throws SnapshotError.
  void finish();
  /// A long series in parts: finish_as puts what there is so far under a name of its own, without XDMF, and append_all_of takes
  /// over all frames of such a part, as they are. Throws SnapshotError.
  void finish_as(const std::filesystem::path& part);
  void append_all_of(const std::filesystem::path& part);

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// Where the XDMF of a snapshot file stands: the same name, ending in .xdmf.
std::filesystem::path xdmf_file(const std::filesystem::path& snapshots);

/// Reads a whole series back, held to the same rules as append(). Throws SnapshotError naming the file and
/// what is wrong with it.
SnapshotSeries read_snapshots(const std::filesystem::path& file);

/// Writes a whole series at once.
void write_snapshots(const std::filesystem::path& file, const SnapshotSeries& series,
                     std::string_view made_by);

}  // namespace talus::analysis
