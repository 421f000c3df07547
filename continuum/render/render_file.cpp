#include "continuum/render/render_file.h"

#include <H5Cpp.h>
#include <fmt/format.h>

#include <array>
#include <new>

#include "analysis/child_reading.h"
#include "analysis/hdf5_input.h"
#include "analysis/series_file.h"
#include "continuum/files/input_error.h"

namespace talus {
namespace {

using analysis::Number;
using analysis::read_integer;
using analysis::read_number;
using analysis::read_text;
using analysis::Sink;
using analysis::Source;

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
  } catch (const std::bad_alloc&) {
    throw error_about(file, "claims more points than there is memory for");
  }
}

/// The frames of a file that is ours, of this version, and whole.
int read_header(const std::filesystem::path& path, const H5::H5File& file) {
  if (read_text(file, "format") != format_name)
    throw error_about(path, fmt::format("not a file of render points (no format = \"{}\")", format_name));
  if (const int version = read_integer(file, "version"); version != format_version)
    throw error_about(path,
                      fmt::format("version {}; this program reads version {}", version, format_version));
  if (!file.attrExists("complete") || read_integer(file, "complete") != 1)
    throw error_about(path, "the run that wrote it did not finish");
  return read_integer(file, "frames");
}

std::vector<double> read_times(const std::filesystem::path& path, const H5::H5File& file) {
  std::vector<double> times;
  const int frames = read_header(path, file);
  for (int frame = 0; frame < frames; ++frame)
    times.push_back(
        read_number(file.openGroup(analysis::frame_name(static_cast<std::size_t>(frame))), "time"));
  return times;
}

/// A dataset of rows of so many components.
template <class Value>
std::vector<Value> read_rows(const H5::Group& group, const char* name, hsize_t components,
                             const H5::PredType& type) {
  const H5::DataSet set = group.openDataSet(name);
  const H5::DataSpace space = set.getSpace();
  std::array<hsize_t, 2> shape{0, 1};
  if (space.getSimpleExtentNdims() != (components == 1 ? 1 : 2))
    throw H5::DataSetIException(name, "another shape was expected");
  space.getSimpleExtentDims(shape.data());
  if (shape[1] != components) throw H5::DataSetIException(name, "another shape was expected");
  analysis::check_claim(set, name, shape[0], components * sizeof(Value));
  std::vector<Value> rows(shape[0] * components);
  if (!rows.empty()) set.read(rows.data(), type);
  return rows;
}

template <class Value>
void give_list(const Sink& sink, const std::vector<Value>& list) {
  sink.put_list(list.data(), list.size());
}

template <class Value>
std::vector<Value> take_list(const Source& source) {
  std::vector<Value> list(source.take_count());
  source.take(list.data(), list.size() * sizeof(Value));
  return list;
}

/// give(sink, the open file) in a child process: HDF5 1.10 hangs over some damaged files and overwrites memory over others.
template <class Give, class Take>
void read_apart(const std::filesystem::path& file, const Give& give, const Take& take) {
  try {
    analysis::read_in_child(
        [&](const Sink& sink) {
          reading(file, [&] { give(sink, H5::H5File(file.string(), H5F_ACC_RDONLY)); });
        },
        [&](const Source& source) { reading(file, [&] { take(source); }); },
        analysis::reading_patience(file));
  } catch (const analysis::ChildRefused& refused) {
    throw InputError(refused.what());
  } catch (const analysis::ChildDied&) {
    throw error_about(file, "damaged: HDF5 crashes or hangs over it");
  }
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

RenderReader::RenderReader(const std::filesystem::path& file) : file_(file) {
  if (!std::filesystem::is_regular_file(file)) {
    throw error_about(
        file,
        "no such file; talus run writes it, at the end of a run, if the scene asks for render points: "
        "[render_points] per_particle = 20");
  }
  const auto give = [&](const Sink& sink, const H5::H5File& hdf5) {
    const std::vector<double> times = read_times(file, hdf5);
    sink.put(read_number(hdf5, "points_per_volume"));
    give_list(sink, times);
  };
  read_apart(file, give, [&](const Source& source) {
    points_per_volume_ = source.take<double>();
    times_ = take_list<double>(source);
  });
}

RenderFrame RenderReader::read(std::size_t index) const {
  const auto give = [&](const Sink& sink, const H5::H5File& hdf5) {
    const H5::Group group = hdf5.openGroup(analysis::frame_name(index));
    give_list(sink, read_rows<float>(group, "positions", 3, H5::PredType::NATIVE_FLOAT));
    give_list(sink, read_rows<float>(group, "normals", 3, H5::PredType::NATIVE_FLOAT));
    give_list(sink, read_rows<std::uint32_t>(group, "identities", 1, H5::PredType::NATIVE_UINT32));
    give_list(sink, read_rows<std::uint8_t>(group, "materials", 1, H5::PredType::NATIVE_UINT8));
    give_list(sink, read_rows<float>(group, "speeds", 1, H5::PredType::NATIVE_FLOAT));
  };
  RenderFrame frame;
  frame.time = times_[index];
  read_apart(file_, give, [&](const Source& source) {
    const auto positions = take_list<float>(source), normals = take_list<float>(source);
    frame.identities = take_list<std::uint32_t>(source);
    frame.materials = take_list<std::uint8_t>(source);
    frame.speeds = take_list<float>(source);
    const std::size_t n = frame.count();
    if (positions.size() != 3 * n || normals.size() != 3 * n || frame.materials.size() != n ||
        frame.speeds.size() != n)
      throw error_about(file_, fmt::format("frame {}: its lists differ in length", index));
    frame.positions = Eigen::Map<const Eigen::Matrix3Xf>(positions.data(), 3, static_cast<Eigen::Index>(n));
    frame.normals = Eigen::Map<const Eigen::Matrix3Xf>(normals.data(), 3, static_cast<Eigen::Index>(n));
  });
  return frame;
}

}  // namespace talus
