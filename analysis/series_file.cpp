#include "analysis/series_file.h"

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
#include <stdexcept>
#include <utility>

#include "analysis/hdf5_input.h"
#include "analysis/snapshot_format.h"
#include "continuum/files/put_in_place.h"

namespace talus::analysis {
namespace {

constexpr unsigned deflate_level = 1;     // light: a run waits while it writes
constexpr hsize_t largest_chunk = 65536;  // rows
constexpr std::uint64_t bookkeeping =
    1 << 20;  // bytes: HDF5's own, of a frame and of the end, with room to spare

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

void write_rows(H5::Group& group, const SeriesItem& item, hsize_t count, bool compressed, const void* data) {
  const std::array<hsize_t, 2> shape{count, item.components};
  const int rank = item.components == 1 ? 1 : 2;
  H5::DSetCreatPropList layout;
  if (count > 0 && compressed) {
    const std::array<hsize_t, 2> chunk{std::min(count, largest_chunk), item.components};
    layout.setChunk(rank, chunk.data());
    layout.setShuffle();
    layout.setDeflate(deflate_level);
  }
  H5::DataSet set =
      group.createDataSet(item.dataset, file_type(item.number), H5::DataSpace(rank, shape.data()), layout);
  if (count > 0) set.write(data, memory_type(item.number));
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

void rename_whole(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (const std::error_code why = put_in_place(from, to))
    throw snapshot_error(to, fmt::format("cannot put in place: {}", why.message()));
}

std::filesystem::path partial(std::filesystem::path file) { return file += ".partial"; }

}  // namespace

H5::PredType file_type(Number number) {
  switch (number) {
    case Number::float64:
      return H5::PredType::IEEE_F64LE;
    case Number::float32:
      return H5::PredType::IEEE_F32LE;
    case Number::uint32:
      return H5::PredType::STD_U32LE;
    case Number::uint8:
      return H5::PredType::STD_U8LE;
  }
  throw std::invalid_argument("unknown kind of number");
}

H5::PredType memory_type(Number number) {
  switch (number) {
    case Number::float64:
      return H5::PredType::NATIVE_DOUBLE;
    case Number::float32:
      return H5::PredType::NATIVE_FLOAT;
    case Number::uint32:
      return H5::PredType::NATIVE_UINT32;
    case Number::uint8:
      return H5::PredType::NATIVE_UINT8;
  }
  throw std::invalid_argument("unknown kind of number");
}

SeriesFile::SeriesFile(std::filesystem::path file, SeriesFormat format, std::string_view made_by)
    : path_(std::move(file)), format_(std::move(format)) {
  translating_errors(path_, "cannot write here", [&] {
    hdf5_ = std::make_unique<H5::H5File>(partial(path_).string(), H5F_ACC_TRUNC);
    talus::analysis::write_attribute(*hdf5_, "format", format_.format);
    talus::analysis::write_attribute(*hdf5_, "version", H5::PredType::NATIVE_INT, &format_.version);
    talus::analysis::write_attribute(*hdf5_, "made_by", made_by);
  });
}

SeriesFile::~SeriesFile() {
  try {
    close();
  } catch (const H5::Exception&) {  // the file is thrown away, so nothing is lost
  }
  std::error_code ignored;
  std::filesystem::remove(partial(path_), ignored);
  std::filesystem::remove(partial(xdmf_file(path_)), ignored);
}

/// HDF5 1.10 crashes when a file that could not be closed (a full disk) is closed once more, as the
/// destructor of H5File would do: such a file is left to the end of the process.
void SeriesFile::close() {
  static std::vector<std::unique_ptr<H5::H5File>>& abandoned = *new std::vector<std::unique_ptr<H5::H5File>>;
  if (!hdf5_) return;
  try {
    hdf5_->close();
  } catch (const H5::Exception&) {
    abandoned.push_back(std::move(hdf5_));
    throw;
  }
  hdf5_.reset();
}

void SeriesFile::write_attribute(const char* name, double value) {
  translating_errors(path_, "cannot write here", [&] {
    talus::analysis::write_attribute(*hdf5_, name, H5::PredType::NATIVE_DOUBLE, &value);
  });
}

std::uint64_t SeriesFile::bytes_of_item() const {
  std::uint64_t bytes = 0;
  for (const SeriesItem& item : format_.items) bytes += item.components * memory_type(item.number).getSize();
  return bytes;
}

void SeriesFile::append(double time, std::size_t count, std::span<const void* const> data) {
  if (!hdf5_) throw snapshot_error(path_, "append after finish: the file is closed");
  translating_errors(path_, "cannot write a frame", [&] {
    reserve_room(partial(path_), hdf5_->getFileSize() + count * bytes_of_item() + bookkeeping);
    H5::Group group = hdf5_->createGroup(frame_name(frames_.size()));
    talus::analysis::write_attribute(group, "time", H5::PredType::NATIVE_DOUBLE, &time);
    for (std::size_t i = 0; i < format_.items.size(); ++i)
      write_rows(group, format_.items[i], count, format_.compressed, data[i]);
  });
  frames_.push_back({time, count});
}

void SeriesFile::append_all_of(const std::filesystem::path& whole) {
  if (!hdf5_) throw snapshot_error(path_, "append after finish: the file is closed");
  translating_errors(whole, "cannot be read as a part of a series", [&] {
    const H5::H5File part(whole.string(), H5F_ACC_RDONLY);
    if (read_text(part, "format") != format_.format || read_integer(part, "complete") != 1)
      throw snapshot_error(whole, "not a part of this series");
    reserve_room(partial(path_), hdf5_->getFileSize() + part.getFileSize() + bookkeeping);
    const int frames = read_integer(part, "frames");
    for (int frame = 0; frame < frames; ++frame) {
      const std::string name = frame_name(static_cast<std::size_t>(frame));
      const H5::Group group = part.openGroup(name);
      FrameEntry entry{.time = read_number(group, "time"), .count = 0};
      std::array<hsize_t, 2> shape{0, 0};
      group.openDataSet(format_.items.front().dataset).getSpace().getSimpleExtentDims(shape.data());
      entry.count = static_cast<std::size_t>(shape[0]);
      if (H5Ocopy(part.getId(), name.c_str(), hdf5_->getId(), frame_name(frames_.size()).c_str(), H5P_DEFAULT,
                  H5P_DEFAULT) < 0)
        throw snapshot_error(path_, fmt::format("cannot take over frame {} of {}", frame, whole.string()));
      frames_.push_back(entry);
    }
  });
}

/// With all that says that it is whole, and on the disk.
void SeriesFile::close_whole() {
  if (!hdf5_) throw snapshot_error(path_, "finish after finish: the file is closed");
  translating_errors(path_, "cannot finish", [&] {
    const int frames = static_cast<int>(frames_.size());
    const int complete = 1;
    reserve_room(partial(path_), hdf5_->getFileSize() + bookkeeping);
    talus::analysis::write_attribute(*hdf5_, "frames", H5::PredType::NATIVE_INT, &frames);
    talus::analysis::write_attribute(*hdf5_, "complete", H5::PredType::NATIVE_INT, &complete);
    close();
  });
  give_back_room(partial(path_));
  flush_to_disk(partial(path_));
}

void SeriesFile::finish_as(const std::filesystem::path& part) {
  close_whole();
  rename_whole(partial(path_), part);
}

void SeriesFile::finish() {
  close_whole();
  const auto xdmf = xdmf_file(path_);
  std::ofstream out(partial(xdmf), std::ios::binary);
  out << xdmf_document(format_.name, path_.filename().string(), format_.items, frames_);
  out.close();
  if (!out) throw snapshot_error(xdmf, "cannot write");
  flush_to_disk(partial(xdmf));
  // The numbers last: where they stand, their description stands as well.
  rename_whole(partial(xdmf), xdmf);
  rename_whole(partial(path_), path_);
}

}  // namespace talus::analysis
