#include <H5Cpp.h>
#include <fmt/format.h>

#include <array>
#include <utility>

#include "analysis/child_reading.h"
#include "analysis/hdf5_input.h"
#include "analysis/snapshot.h"
#include "analysis/snapshot_format.h"
#include "analysis/xdmf.h"

namespace talus::analysis {
namespace {

constexpr const char* reading_failed = "damaged, or not a snapshot file";

/// The number of rows of a dataset that must have `columns` columns (1: a plain list).
hsize_t row_count(const H5::DataSet& set, hsize_t columns, const char* name) {
  const H5::DataSpace space = set.getSpace();
  std::array<hsize_t, 2> shape{0, 1};
  const int rank = space.getSimpleExtentNdims();
  const bool right_rank = rank == (columns == 1 ? 1 : 2);
  if (right_rank) space.getSimpleExtentDims(shape.data());
  if (!right_rank || shape[1] != columns || set.getTypeClass() != H5T_FLOAT) {
    throw H5::DataSetIException(name, fmt::format("not a float table with {} columns", columns));
  }
  check_claim(set, name, shape[0], columns * sizeof(double));
  return shape[0];
}

Vectors read_vectors(const H5::Group& group, const char* name) {
  const H5::DataSet set = group.openDataSet(name);
  Vectors vectors(3, static_cast<Eigen::Index>(row_count(set, 3, name)));
  if (vectors.cols() > 0) set.read(vectors.data(), H5::PredType::NATIVE_DOUBLE);
  return vectors;
}

Snapshot read_frame(const H5::H5File& file, const std::string& name) {
  const H5::Group group = file.openGroup(name);
  Snapshot snapshot;
  snapshot.time = read_number(group, "time");
  snapshot.positions = read_vectors(group, "positions");
  snapshot.velocities = read_vectors(group, "velocities");
  const H5::DataSet volumes = group.openDataSet("volumes");
  snapshot.volumes.resize(static_cast<Eigen::Index>(row_count(volumes, 1, "volumes")));
  if (snapshot.volumes.size() > 0) volumes.read(snapshot.volumes.data(), H5::PredType::NATIVE_DOUBLE);
  return snapshot;
}

/// The number of frames of a file that is ours, of this version, and whole.
std::size_t read_header(const std::filesystem::path& path, const H5::H5File& file) {
  if (read_text(file, "format") != format_name)
    throw snapshot_error(path, "not a Talus snapshot file (no format = \"talus-snapshots\")");
  if (const int version = read_integer(file, "version"); version != format_version) {
    throw snapshot_error(
        path, fmt::format("snapshot version {}; this program reads version {}", version, format_version));
  }
  if (!file.attrExists("complete") || read_integer(file, "complete") != 1) {
    throw snapshot_error(path, "the run that wrote it did not finish");
  }
  const int frames = read_integer(file, "frames");
  if (frames < 0) throw snapshot_error(path, fmt::format("claims {} frames", frames));
  return static_cast<std::size_t>(frames);
}

Vectors take_vectors(const Source& source) {
  Vectors vectors(3, static_cast<Eigen::Index>(source.take_count()));
  source.take(vectors.data(), static_cast<std::size_t>(vectors.size()) * sizeof(double));
  return vectors;
}

void give_all(const std::filesystem::path& path, const Sink& sink) {
  translating_errors(path, reading_failed, [&] {
    const H5::H5File file(path.string(), H5F_ACC_RDONLY);
    const std::size_t frames = read_header(path, file);
    sink.put(frames);
    for (std::size_t index = 0; index < frames; ++index) {
      const Snapshot frame = read_frame(file, frame_name(index));
      sink.put(frame.time);
      for (const Vectors* vectors : {&frame.positions, &frame.velocities}) {
        sink.put(static_cast<std::size_t>(vectors->cols()));
        sink.put(vectors->data(), static_cast<std::size_t>(vectors->size()) * sizeof(double));
      }
      sink.put_list(frame.volumes.data(), static_cast<std::size_t>(frame.volumes.size()));
    }
  });
}

SnapshotSeries take_all(const std::filesystem::path& path, const Source& source) {
  SnapshotSeries series;
  const auto frames = source.take<std::size_t>();
  for (std::size_t index = 0; index < frames; ++index) {
    Snapshot frame;
    frame.time = source.take<double>();
    frame.positions = take_vectors(source);
    frame.velocities = take_vectors(source);
    frame.volumes.resize(static_cast<Eigen::Index>(source.take_count()));
    source.take(frame.volumes.data(), static_cast<std::size_t>(frame.volumes.size()) * sizeof(double));
    check_frame(path, index, frame, index > 0 ? series[index - 1].time : 0.0);
    series.push_back(std::move(frame));
  }
  return series;
}

}  // namespace

SnapshotSeries read_snapshots(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) throw snapshot_error(path, "no such file");
  SnapshotSeries series;
  try {
    // HDF5 1.10 hangs over some damaged files and overwrites memory over others (tests/fuzz/README.md).
    translating_errors(path, reading_failed, [&] {
      read_in_child([&](const Sink& sink) { give_all(path, sink); },
                    [&](const Source& source) { series = take_all(path, source); }, reading_patience(path));
    });
  } catch (const ChildRefused& refused) {
    throw SnapshotError(refused.what());
  } catch (const ChildDied&) {
    throw snapshot_error(path, "damaged: HDF5 crashes or hangs over it");
  }
  return series;
}

}  // namespace talus::analysis
