// The XDMF text that lets ParaView and VisIt open a file of frames: a temporal collection of point clouds whose numbers stay
// in the HDF5 file.
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

/// How numbers stand in the HDF5 file.
enum class Number { float64, float32, uint32, uint8 };

/// One dataset of each frame.
struct SeriesItem {
  const char* dataset;
  const char* attribute;  // its name in pictures; empty for the places of the points
  Number number;
  std::size_t components;  // 1, or 3: a vector
};

/// Name of the HDF5 group of a frame: "frame_000000" and so on.
std::string frame_name(std::size_t index);

/// The XDMF document for an HDF5 file that stands in the same folder under `file_name`; `name`: of the series.
std::string xdmf_document(std::string_view name, std::string_view file_name,
                          std::span<const SeriesItem> items, std::span<const FrameEntry> frames);

}  // namespace talus::analysis
