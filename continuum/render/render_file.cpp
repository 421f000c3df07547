#include "continuum/render/render_file.h"

#include <H5Cpp.h>
#include <fmt/format.h>

#include <array>

#include "analysis/series_file.h"
#include "continuum/files/input_error.h"

namespace talus {
namespace {

using analysis::Number;

constexpr const char* format_name = "talus-render-points";
constexpr int format_version = 1;

analysis::SeriesFormat render_format() {
  return {format_name,
          format_version,
          "render points",
          {{"positions", "", Number::float32, 3},
           {"normals", "normal", Number::float32, 3},
           {"identities", "identity", Number::uint32, 1},
           {"materials", "material", Number::uint8, 1},
           {"speeds", "speed", Number::float32, 1}},
          false};
}

InputError error_about(const std::filesystem::path& file, std::string_view what) {
  return InputError(fmt::format("{}: {}", file.string(), what));
}

/// What HDF5 says goes into one InputError that names the file.
template <class Action>
auto reading(const std::filesystem::path& file, const Action& action) {
  H5::Exception::dontPrint();
  try {
    return action();
  } catch (const H5::Exception& error) {
    throw error_about(file, fmt::format("damaged, or not a file of render points: HDF5 says '{}' in {}",
                                        error.getDetailMsg(), error.getFuncName()));
  }
}

int read_integer(const H5::H5File& file, const char* name) {
  int value = 0;
  file.openAttribute(name).read(H5::PredType::NATIVE_INT, &value);
  return value;
}

double read_number(const H5::H5Object& object, const char* name) {
  double value = 0.0;
  object.openAttribute(name).read(H5::PredType::NATIVE_DOUBLE, &value);
  return value;
}

/// The frames of a file that is ours, of this version, and whole.
int read_header(const std::filesystem::path& path, const H5::H5File& file) {
  std::string format;
  if (file.attrExists("format")) {
    const H5::Attribute attribute = file.openAttribute("format");
    if (attribute.getTypeClass() == H5T_STRING) attribute.read(attribute.getStrType(), format);
  }
  if (format != format_name)
    throw error_about(path, fmt::format("not a file of render points (no format = \"{}\")", format_name));
  if (const int version = read_integer(file, "version"); version != format_version)
    throw error_about(path,
                      fmt::format("version {}; this program reads version {}", version, format_version));
  if (!file.attrExists("complete") || read_integer(file, "complete") != 1)
    throw error_about(path, "the run that wrote it did not finish");
  return read_integer(file, "frames");
}

/// Reads all of a dataset of n rows into what `room(n)` gives.
template <class Room>
void read_rows(const H5::Group& group, const char* name, hsize_t components, const H5::PredType& type,
               const Room& room) {
  const H5::DataSet set = group.openDataSet(name);
  const H5::DataSpace space = set.getSpace();
  std::array<hsize_t, 2> shape{0, 1};
  if (space.getSimpleExtentNdims() != (components == 1 ? 1 : 2))
    throw H5::DataSetIException(name, "another shape was expected");
  space.getSimpleExtentDims(shape.data());
  if (shape[1] != components) throw H5::DataSetIException(name, "another shape was expected");
  void* const rows = room(static_cast<std::size_t>(shape[0]));
  if (shape[0] > 0) set.read(rows, type);
}

Eigen::Matrix3Xf read_vectors(const H5::Group& group, const char* name) {
  Eigen::Matrix3Xf vectors;
  read_rows(group, name, 3, H5::PredType::NATIVE_FLOAT, [&](std::size_t n) {
    vectors.resize(3, static_cast<Eigen::Index>(n));
    return vectors.data();
  });
  return vectors;
}

template <class Value>
std::vector<Value> read_list(const H5::Group& group, const char* name, const H5::PredType& type) {
  std::vector<Value> values;
  read_rows(group, name, 1, type, [&](std::size_t n) {
    values.resize(n);
    return values.data();
  });
  return values;
}

}  // namespace

struct RenderWriter::File {
  analysis::SeriesFile series;
};

RenderWriter::RenderWriter(const std::filesystem::path& file, double points_per_volume,
                           std::string_view made_by)
    : file_(new File{{file, render_format(), made_by}}) {
  file_->series.write_attribute("points_per_volume", points_per_volume);
}

RenderWriter::~RenderWriter() = default;

void RenderWriter::append(const RenderFrame& frame) {
  const std::array<const void*, 5> data{frame.positions.data(), frame.normals.data(), frame.identities.data(),
                                        frame.materials.data(), frame.speeds.data()};
  file_->series.append(frame.time, frame.count(), data);
}

void RenderWriter::finish() { file_->series.finish(); }
void RenderWriter::finish_as(const std::filesystem::path& part) { file_->series.finish_as(part); }
void RenderWriter::append_all_of(const std::filesystem::path& part) { file_->series.append_all_of(part); }

struct RenderReader::File {
  std::filesystem::path path;
  H5::H5File hdf5;
};

RenderReader::RenderReader(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) {
    throw error_about(
        path,
        "no such file; talus run writes it, at the end of a run, if the scene asks for render points: "
        "[render_points] per_particle = 20");
  }
  reading(path, [&] {
    file_.reset(new File{path, H5::H5File(path.string(), H5F_ACC_RDONLY)});
    const int frames = read_header(path, file_->hdf5);
    points_per_volume_ = read_number(file_->hdf5, "points_per_volume");
    for (int frame = 0; frame < frames; ++frame)
      times_.push_back(
          read_number(file_->hdf5.openGroup(analysis::frame_name(static_cast<std::size_t>(frame))), "time"));
  });
}

RenderReader::~RenderReader() = default;
RenderReader::RenderReader(RenderReader&&) noexcept = default;
RenderReader& RenderReader::operator=(RenderReader&&) noexcept = default;

RenderFrame RenderReader::read(std::size_t index) const {
  return reading(file_->path, [&] {
    const H5::Group group = file_->hdf5.openGroup(analysis::frame_name(index));
    RenderFrame frame{times_[index],
                      read_vectors(group, "positions"),
                      read_vectors(group, "normals"),
                      read_list<std::uint32_t>(group, "identities", H5::PredType::NATIVE_UINT32),
                      read_list<std::uint8_t>(group, "materials", H5::PredType::NATIVE_UINT8),
                      read_list<float>(group, "speeds", H5::PredType::NATIVE_FLOAT)};
    const std::size_t n = frame.count();
    if (static_cast<std::size_t>(frame.positions.cols()) != n ||
        static_cast<std::size_t>(frame.normals.cols()) != n || frame.materials.size() != n ||
        frame.speeds.size() != n)
      throw error_about(file_->path, fmt::format("frame {}: its lists differ in length", index));
    return frame;
  });
}

}  // namespace talus
