#include "analysis/snapshot.h"

#include <H5Cpp.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <new>
#include <span>
#include <utility>

#include "analysis/xdmf.h"

namespace talus::analysis {
namespace {

constexpr const char* format_name = "talus-snapshots";
constexpr int format_version = 1;
constexpr unsigned deflate_level = 1;     // light: a run waits while it writes
constexpr hsize_t largest_chunk = 65536;  // rows

SnapshotError error(const std::filesystem::path& file, std::string_view what) {
  return SnapshotError(fmt::format("{}: {}", file.string(), what));
}

/// Runs `action`; whatever HDF5 says goes into one SnapshotError that names the file.
template <typename Action>
auto translating_errors(const std::filesystem::path& file, std::string_view doing, Action&& action) {
  H5::Exception::dontPrint();
  try {
    return action();
  } catch (const H5::Exception& exception) {
    throw error(file, fmt::format("{}: HDF5 says '{}' in {}", doing, exception.getDetailMsg(),
                                  exception.getFuncName()));
  } catch (const std::bad_alloc&) {
    throw error(file, fmt::format("{}: the file claims more data than there is memory", doing));
  }
}

/// The rules of one frame, for writing and reading alike. `previous` is the time of the frame before.
void check_frame(const std::filesystem::path& file, std::size_t index, const Snapshot& snapshot,
                 double previous) {
  const auto fail = [&](std::string_view what) {
    throw error(file, fmt::format("frame {} (t = {} s): {}", index, snapshot.time, what));
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

H5::StrType text_type() {
  H5::StrType type(H5::PredType::C_S1, H5T_VARIABLE);
  type.setCset(H5T_CSET_UTF8);
  return type;
}

void write_attribute(H5::H5Object& object, const char* name, std::string_view text) {
  object.createAttribute(name, text_type(), H5::DataSpace()).write(text_type(), std::string(text));
}

void write_attribute(H5::H5Object& object, const char* name, const H5::PredType& type, const void* value) {
  object.createAttribute(name, type, H5::DataSpace()).write(type, value);
}

/// `rows` is all of `data` in row-major order: a 3 x n matrix stored by columns is n rows of 3.
void write_rows(H5::Group& group, const char* name, std::span<const hsize_t> shape, const double* data) {
  H5::DSetCreatPropList layout;
  if (shape[0] > 0) {
    std::array<hsize_t, 2> chunk{std::min(shape[0], largest_chunk), 3};
    layout.setChunk(static_cast<int>(shape.size()), chunk.data());
    layout.setShuffle();
    layout.setDeflate(deflate_level);
  }
  const H5::DataSpace space(static_cast<int>(shape.size()), shape.data());
  H5::DataSet set = group.createDataSet(name, H5::PredType::IEEE_F64LE, space, layout);
  if (shape[0] > 0) set.write(data, H5::PredType::NATIVE_DOUBLE);
}

void write_frame(H5::H5File& file, const std::string& name, const Snapshot& snapshot) {
  H5::Group group = file.createGroup(name);
  const std::array<hsize_t, 2> vectors{static_cast<hsize_t>(snapshot.volumes.size()), 3};
  const std::span<const hsize_t> scalars(vectors.data(), 1);
  write_attribute(group, "time", H5::PredType::NATIVE_DOUBLE, &snapshot.time);
  write_rows(group, "positions", vectors, snapshot.positions.data());
  write_rows(group, "velocities", vectors, snapshot.velocities.data());
  write_rows(group, "volumes", scalars, snapshot.volumes.data());
}

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
  if (format != format_name) throw error(path, "not a Talus snapshot file (no format = \"talus-snapshots\")");
  if (const int version = read_integer(file, "version"); version != format_version) {
    throw error(path,
                fmt::format("snapshot version {}; this program reads version {}", version, format_version));
  }
  if (!file.attrExists("complete") || read_integer(file, "complete") != 1) {
    throw error(path, "the run that wrote it did not finish");
  }
  const int frames = read_integer(file, "frames");
  if (frames < 0) throw error(path, fmt::format("claims {} frames", frames));
  return static_cast<std::size_t>(frames);
}

void flush_to_disk(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const bool flushed = descriptor >= 0 && ::fsync(descriptor) == 0;
  const int why = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (!flushed) throw error(file, fmt::format("cannot flush to disk: {}", std::strerror(why)));
}

void put_in_place(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code why;
  std::filesystem::rename(from, to, why);
  if (why) throw error(to, fmt::format("cannot put in place: {}", why.message()));
}

std::filesystem::path partial(std::filesystem::path file) { return file += ".partial"; }

}  // namespace

struct SnapshotWriter::File {
  std::filesystem::path path;
  H5::H5File hdf5;
  std::vector<FrameEntry> frames;
};

SnapshotWriter::SnapshotWriter(std::filesystem::path file, std::string_view made_by)
    : file_(std::make_unique<File>()) {
  file_->path = std::move(file);
  translating_errors(file_->path, "cannot write here", [&] {
    file_->hdf5 = H5::H5File(partial(file_->path).string(), H5F_ACC_TRUNC);
    write_attribute(file_->hdf5, "format", format_name);
    write_attribute(file_->hdf5, "version", H5::PredType::NATIVE_INT, &format_version);
    write_attribute(file_->hdf5, "made_by", made_by);
  });
}

SnapshotWriter::~SnapshotWriter() {
  if (!file_) return;
  try {
    file_->hdf5.close();
  } catch (const H5::Exception&) {  // the file is thrown away, so nothing is lost
  }
  std::error_code ignored;
  std::filesystem::remove(partial(file_->path), ignored);
  std::filesystem::remove(partial(xdmf_file(file_->path)), ignored);
}

void SnapshotWriter::append(const Snapshot& snapshot) {
  if (!file_) throw SnapshotError("append after finish: the snapshot file is closed");
  const std::size_t index = file_->frames.size();
  check_frame(file_->path, index, snapshot, index > 0 ? file_->frames.back().time : 0.0);
  translating_errors(file_->path, "cannot write a frame",
                     [&] { write_frame(file_->hdf5, frame_name(index), snapshot); });
  file_->frames.push_back({snapshot.time, static_cast<std::size_t>(snapshot.volumes.size())});
}

void SnapshotWriter::finish() {
  if (!file_) throw SnapshotError("finish after finish: the snapshot file is closed");
  const auto& path = file_->path;
  translating_errors(path, "cannot finish", [&] {
    const int frames = static_cast<int>(file_->frames.size());
    const int complete = 1;
    write_attribute(file_->hdf5, "frames", H5::PredType::NATIVE_INT, &frames);
    write_attribute(file_->hdf5, "complete", H5::PredType::NATIVE_INT, &complete);
    file_->hdf5.close();
  });
  const auto xdmf = xdmf_file(path);
  std::ofstream out(partial(xdmf), std::ios::binary);
  out << xdmf_document(path.filename().string(), file_->frames);
  out.close();
  if (!out) throw error(xdmf, "cannot write");
  flush_to_disk(partial(path));
  flush_to_disk(partial(xdmf));
  // The snapshots last: where they stand, their description stands as well.
  put_in_place(partial(xdmf), xdmf);
  put_in_place(partial(path), path);
  file_.reset();
}

std::filesystem::path xdmf_file(const std::filesystem::path& snapshots) {
  auto file = snapshots;
  return file.replace_extension(".xdmf");
}

SnapshotSeries read_snapshots(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) throw error(path, "no such file");
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

void write_snapshots(const std::filesystem::path& file, const SnapshotSeries& series,
                     std::string_view made_by) {
  SnapshotWriter writer(file, made_by);
  for (const Snapshot& snapshot : series) writer.append(snapshot);
  writer.finish();
}

}  // namespace talus::analysis
