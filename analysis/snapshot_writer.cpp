#include <H5Cpp.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <span>
#include <utility>

#include "analysis/snapshot.h"
#include "analysis/snapshot_format.h"
#include "analysis/xdmf.h"

namespace talus::analysis {
namespace {

constexpr unsigned deflate_level = 1;     // light: a run waits while it writes
constexpr hsize_t largest_chunk = 65536;  // rows

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

void flush_to_disk(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const bool flushed = descriptor >= 0 && ::fsync(descriptor) == 0;
  const int why = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (!flushed) throw snapshot_error(file, fmt::format("cannot flush to disk: {}", std::strerror(why)));
}

/// Sets disk space aside for the first `bytes` of the file, so that a full disk is noticed here. HDF5 1.10
/// does not survive it: once a write has failed, closing the library at the end of the process crashes. On
/// file systems that cannot set space aside this does nothing.
void reserve_room(const std::filesystem::path& file, std::uint64_t bytes) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) throw snapshot_error(file, fmt::format("cannot write: {}", std::strerror(errno)));
  rlimit limit{};
  ::getrlimit(RLIMIT_FSIZE, &limit);
  const bool allowed = bytes <= limit.rlim_cur;
  const bool reserved = ::fallocate(descriptor, FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes)) == 0;
  const int why = allowed ? errno : EFBIG;
  ::close(descriptor);
  if (allowed && (reserved || why == EOPNOTSUPP || why == ENOSYS)) return;
  throw snapshot_error(file, fmt::format("no room for the next frame: {}", std::strerror(why)));
}

/// What was reserved beyond the end goes back with a cut to the size that the file has; failing that, no harm
/// is done.
void give_back_room(const std::filesystem::path& file) {
  std::error_code ignored;
  const auto size = std::filesystem::file_size(file, ignored);
  if (!ignored) std::filesystem::resize_file(file, size, ignored);
}

void put_in_place(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code why;
  std::filesystem::rename(from, to, why);
  if (why) throw snapshot_error(to, fmt::format("cannot put in place: {}", why.message()));
}

std::filesystem::path partial(std::filesystem::path file) { return file += ".partial"; }

}  // namespace

struct SnapshotWriter::File {
  std::filesystem::path path;
  std::unique_ptr<H5::H5File> hdf5;
  std::vector<FrameEntry> frames;

  /// Before `snapshot` is written, or before the end where there is none.
  void reserve_room_for(const Snapshot* snapshot) const {
    constexpr std::uint64_t bookkeeping = 1
                                          << 20;  // HDF5's own, of a frame and of the end, with room to spare
    const auto numbers = snapshot ? static_cast<std::uint64_t>(7 * snapshot->volumes.size()) : 0;
    reserve_room(partial(path), hdf5->getFileSize() + numbers * sizeof(double) + bookkeeping);
  }

  /// HDF5 1.10 crashes when a file that could not be closed (a full disk) is closed once more, as the
  /// destructor of H5File would do: such a file is left to the end of the process.
  void close() {
    static std::vector<std::unique_ptr<H5::H5File>>& abandoned =
        *new std::vector<std::unique_ptr<H5::H5File>>;
    if (!hdf5) return;
    try {
      hdf5->close();
    } catch (const H5::Exception&) {
      abandoned.push_back(std::move(hdf5));
      throw;
    }
    hdf5.reset();
  }
};

SnapshotWriter::SnapshotWriter(std::filesystem::path file, std::string_view made_by)
    : file_(std::make_unique<File>()) {
  file_->path = std::move(file);
  translating_errors(file_->path, "cannot write here", [&] {
    file_->hdf5 = std::make_unique<H5::H5File>(partial(file_->path).string(), H5F_ACC_TRUNC);
    write_attribute(*file_->hdf5, "format", format_name);
    write_attribute(*file_->hdf5, "version", H5::PredType::NATIVE_INT, &format_version);
    write_attribute(*file_->hdf5, "made_by", made_by);
  });
}

SnapshotWriter::~SnapshotWriter() {
  if (!file_) return;
  try {
    file_->close();
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
  translating_errors(file_->path, "cannot write a frame", [&] {
    file_->reserve_room_for(&snapshot);
    write_frame(*file_->hdf5, frame_name(index), snapshot);
  });
  file_->frames.push_back({snapshot.time, static_cast<std::size_t>(snapshot.volumes.size())});
}

void SnapshotWriter::finish() {
  if (!file_) throw SnapshotError("finish after finish: the snapshot file is closed");
  const auto& path = file_->path;
  translating_errors(path, "cannot finish", [&] {
    const int frames = static_cast<int>(file_->frames.size());
    const int complete = 1;
    file_->reserve_room_for(nullptr);
    write_attribute(*file_->hdf5, "frames", H5::PredType::NATIVE_INT, &frames);
    write_attribute(*file_->hdf5, "complete", H5::PredType::NATIVE_INT, &complete);
    file_->close();
  });
  give_back_room(partial(path));
  const auto xdmf = xdmf_file(path);
  std::ofstream out(partial(xdmf), std::ios::binary);
  out << xdmf_document(path.filename().string(), file_->frames);
  out.close();
  if (!out) throw snapshot_error(xdmf, "cannot write");
  flush_to_disk(partial(path));
  flush_to_disk(partial(xdmf));
  // The snapshots last: where they stand, their description stands as well.
  put_in_place(partial(xdmf), xdmf);
  put_in_place(partial(path), path);
  file_.reset();
}

void write_snapshots(const std::filesystem::path& file, const SnapshotSeries& series,
                     std::string_view made_by) {
  SnapshotWriter writer(file, made_by);
  for (const Snapshot& snapshot : series) writer.append(snapshot);
  writer.finish();
}

}  // namespace talus::analysis
