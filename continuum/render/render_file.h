// What is drawn of a run, on disk: render.h5, with render.xdmf beside it, which ParaView opens with real time stamps.
//
//   /              attributes: format = "talus-render-points", version = 1, made_by, frames, complete = 1,
//                  points_per_volume (1/m^3 of sand at its packing limit)
//   /frame_000000  attribute: time (s)
//     positions (n, 3) float32   m
//     normals (n, 3)   float32   unit vectors out of the sand, each with its point's own jitter
//     identities (n)   uint32    stay with the points from frame to frame
//     materials (n)    uint8     index into the scene's materials
//     speeds (n)       float32   m/s, of the particle that a point belongs to
//
// 33 bytes a point and frame, not compressed: deflate takes longer than drawing the points takes to compute.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

namespace talus {

struct RenderFrame {
  double time = 0.0;           // s
  Eigen::Matrix3Xf positions;  // m
  Eigen::Matrix3Xf normals;
  std::vector<std::uint32_t> identities;
  std::vector<std::uint8_t> materials;
  std::vector<float> speeds;  // m/s

  std::size_t count() const { return identities.size(); }
};

/// Writes frames one at a time; nothing stands under the final name until finish() has returned. Throws
/// analysis::SnapshotError when a disk is full or a place cannot be written to.
class RenderWriter {
 public:
  RenderWriter(const std::filesystem::path& file, double points_per_volume, std::string_view made_by);
  ~RenderWriter();
  void append(const RenderFrame& frame);
  void finish();
  /// As SnapshotWriter has them.
  void finish_as(const std::filesystem::path& part);
  void append_all_of(const std::filesystem::path& part);

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// Reads a frame at a time, so that no more than one need be in memory.
class RenderReader {
 public:
  /// Throws InputError when the file is not there, not ours, or not whole.
  explicit RenderReader(const std::filesystem::path& file);

  std::size_t frame_count() const { return times_.size(); }
  double time(std::size_t frame) const { return times_[frame]; }  // s
  double points_per_volume() const { return points_per_volume_; }
  /// Throws InputError when the file is damaged.
  RenderFrame read(std::size_t frame) const;

 private:
  std::filesystem::path file_;
  std::vector<double> times_;
  double points_per_volume_ = 0.0;
};

}  // namespace talus
