// The XDMF text that lets ParaView and VisIt open a snapshot file: a temporal collection of point clouds
// whose numbers stay in the HDF5 file.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace talus::analysis {

/// One frame as the XDMF must know it.
struct FrameEntry {
  double time;        // s
  std::size_t count;  // items in the frame
};

/// Name of the HDF5 group of a frame: "frame_000000" and so on.
std::string frame_name(std::size_t index);

/// The XDMF document for an HDF5 file that stands in the same folder under `snapshot_file_name`.
std::string xdmf_document(std::string_view snapshot_file_name, std::span<const FrameEntry> frames);

}  // namespace talus::analysis
