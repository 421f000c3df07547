#include <H5Cpp.h>
#include <fmt/format.h>

#include <array>
#include <limits>
#include <new>

#include "analysis/snapshot.h"
#include "analysis/snapshot_format.h"
#include "analysis/survives.h"
#include "analysis/xdmf.h"

namespace talus::analysis {
namespace {

/// Deflate packs at most 1032 bytes into one. A damaged count must not ask for more memory than a file of that size can fill.
constexpr double largest_compression = 1100.0;

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
  constexpr auto most = static_cast<hsize_t>(std::numeric_limits<Eigen::Index>::max()) / 3 / sizeof(double);
  if (shape[0] > most) throw std::bad_alloc();
  const double bytes = static_cast<double>(shape[0]) * static_cast<double>(columns) * sizeof(double);
  if (bytes > largest_compression * static_cast<double>(std::filesystem::file_size(set.getFileName())))
    throw H5::DataSetIException(name, fmt::format("claims {} rows, more than the file can hold", shape[0]));
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
  group.openAttribute("time").read(H5::PredType::NATIVE_DOUBLE, &snapshot.time);
  snapshot.positions = read_vectors(group, "positions");
  snapshot.velocities = read_vectors(group, "velocities");
  const H5::DataSet volumes = group.openDataSet("volumes");
  snapshot.volumes.resize(static_cast<Eigen::Index>(row_count(volumes, 1, "volumes")));
  if (snapshot.volumes.size() > 0) volumes.read(snapshot.volumes.data(), H5::PredType::NATIVE_DOUBLE);
  return snapshot;
}

int read_integer(const H5::H5File& file, const char* name) {
  int value = 0;
  file.openAttribute(name).read(H5::PredType::NATIVE_INT, &value);
  return value;
}

/// The number of frames of a file that is ours, of this version, and whole.
std::size_t read_header(const std::filesystem::path& path, const H5::H5File& file) {
  std::string format;
  if (file.attrExists("format")) {
    const H5::Attribute attribute = file.openAttribute("format");
    if (attribute.getTypeClass() == H5T_STRING) attribute.read(attribute.getStrType(), format);
  }
  if (format != format_name)
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

SnapshotSeries read_all(const std::filesystem::path& path) {
  return translating_errors(path, "damaged, or not a snapshot file", [&] {
    const H5::H5File file(path.string(), H5F_ACC_RDONLY);
    const std::size_t frames = read_header(path, file);
    SnapshotSeries series;
    for (std::size_t index = 0; index < frames; ++index) {
      series.push_back(read_frame(file, frame_name(index)));
      check_frame(path, index, series.back(), index > 0 ? series[index - 1].time : 0.0);
    }
    return series;
  });
}

/// Processor time that reading may take: far more than it does.
double patience(const std::filesystem::path& path) {
  constexpr double least = 3.0, seconds_per_byte = 1e-6;
  return least + seconds_per_byte * static_cast<double>(std::filesystem::file_size(path));
}

}  // namespace

SnapshotSeries read_snapshots(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) throw snapshot_error(path, "no such file");
  // HDF5 1.10 hangs over some damaged files and crashes over others (tests/fuzz/README.md), so a copy of this process reads first.
  if (!survives([&] { read_all(path); }, patience(path)))
    throw snapshot_error(path, "damaged: HDF5 crashes or hangs over it");
  return read_all(path);
}

}  // namespace talus::analysis
