// An HDF5 file of frames that grows while a program runs, with its XDMF beside it. Both are written under other names, flushed
// to the disk and renamed when the series is whole, so that a file of that name is never half a run.
//
//   /              attributes: format, version, made_by, frames, complete = 1, and what the writer adds
//   /frame_000000  attribute: time (s); the items, each n or n x 3 numbers
#pragma once

#include <H5Cpp.h>

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/xdmf.h"

namespace talus::analysis {

/// What tells one kind of file from another.
struct SeriesFormat {
  const char* format;
  int version;
  const char* name;  // of the series in the XDMF
  std::vector<SeriesItem> items;
  bool compressed;  // shuffled and lightly deflated; else as it is, which costs no time
};

/// The type of HDF5 that stands for a kind of number, in files and in memory.
H5::PredType file_type(Number number);
H5::PredType memory_type(Number number);

/// All of it throws SnapshotError, and nothing that was refused is written; what HDF5 itself throws is translated too.
class SeriesFile {
 public:
  SeriesFile(std::filesystem::path file, SeriesFormat format, std::string_view made_by);
  ~SeriesFile();  // removes the unfinished file
  SeriesFile(const SeriesFile&) = delete;
  SeriesFile& operator=(const SeriesFile&) = delete;

  void write_attribute(const char* name, double value);
  /// `data`: for each item of the format, its numbers row by row.
  void append(double time, std::size_t count, std::span<const void* const> data);
  /// Takes over, as they are, all frames of a whole file of the same format.
  void append_all_of(const std::filesystem::path& whole);
  /// Closes the file, flushes it to the disk, and puts it and its XDMF in place.
  void finish();
  /// The same under another name in place of its own, and without XDMF: for a part of a series.
  void finish_as(const std::filesystem::path& part);

  const std::filesystem::path& path() const { return path_; }
  std::span<const FrameEntry> frames() const { return frames_; }

 private:
  std::uint64_t bytes_of_item() const;
  void close();
  void close_whole();

  std::filesystem::path path_;
  SeriesFormat format_;
  std::unique_ptr<H5::H5File> hdf5_;
  std::vector<FrameEntry> frames_;
};

}  // namespace talus::analysis
