#include "continuum/render/export.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"
#include "continuum/files/provenance.h"
#include "continuum/render/run_folder.h"

namespace talus {
namespace {

static_assert(std::endian::native == std::endian::little, "both formats are written as the memory has it");

using Bytes = std::array<std::uint8_t, 3>;

/// Of each shade of each material.
std::vector<Bytes> bytes_of_shades(const std::vector<Colour>& colours) {
  std::vector<Bytes> bytes;
  for (const Colour& colour : colours) {
    for (int shade = 0; shade < shades; ++shade) {
      const Eigen::Vector3d levels = (255.0 * shaded(colour, shade)).array().round();
      bytes.push_back({static_cast<std::uint8_t>(levels[0]), static_cast<std::uint8_t>(levels[1]),
                       static_cast<std::uint8_t>(levels[2])});
    }
  }
  return bytes;
}

const Bytes& bytes_of_point(const std::vector<Bytes>& of_shades, const RenderFrame& frame,
                            std::size_t point) {
  return of_shades[static_cast<std::size_t>(frame.materials[point] * shades +
                                            shade_of(frame.identities[point]))];
}

template <class Value>
void append(std::string& text, const Value* values, std::size_t count) {
  text.append(reinterpret_cast<const char*>(values), count * sizeof(Value));
}

/// VTK's appended arrays: their description, and their numbers behind a count of bytes each.
class AppendedArrays {
 public:
  template <class Value>
  std::string add(const char* type, const char* name, int components, const Value* values,
                  std::size_t count) {
    std::string tag = fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        type, name, components, numbers_.size());
    const std::uint64_t bytes = count * sizeof(Value);
    append(numbers_, &bytes, 1);
    append(numbers_, values, count);
    return tag;
  }
  const std::string& numbers() const { return numbers_; }

 private:
  std::string numbers_;
};

}  // namespace

std::string ply_of(const RenderFrame& frame, const std::vector<Colour>& colours, const std::string& comment) {
  std::string text = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment {}\ncomment t = {:.9g} s\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property uchar material\nproperty uint identity\nend_header\n",
      comment, frame.time, frame.count());
  const std::vector<Bytes> of_shades = bytes_of_shades(colours);
  constexpr std::size_t bytes_of_point_in_file = 32;
  text.reserve(text.size() + bytes_of_point_in_file * frame.count());
  for (std::size_t k = 0; k < frame.count(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    append(text, frame.positions.col(column).data(), 3);
    append(text, frame.normals.col(column).data(), 3);
    append(text, bytes_of_point(of_shades, frame, k).data(), 3);
    append(text, &frame.materials[k], 1);
    append(text, &frame.identities[k], 1);
  }
  return text;
}

std::string vtp_of(const RenderFrame& frame, const std::vector<Colour>& colours, const std::string& comment) {
  const std::size_t n = frame.count();
  const std::vector<Bytes> of_shades = bytes_of_shades(colours);
  std::vector<Bytes> rgb(n);
  for (std::size_t k = 0; k < n; ++k) rgb[k] = bytes_of_point(of_shades, frame, k);
  std::vector<std::int64_t> vertices(n), ends(n);
  std::iota(vertices.begin(), vertices.end(), 0);
  std::iota(ends.begin(), ends.end(), 1);

  AppendedArrays arrays;
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<!-- {} -->\n"
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<PolyData>\n"
      "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
      "format=\"ascii\">{:.17g}"
      "</DataArray></FieldData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\">\n"
      "<PointData Scalars=\"colour\" Normals=\"normal\">\n",
      comment, frame.time, n, n);
  text += arrays.add("Float32", "normal", 3, frame.normals.data(), 3 * n);
  text += arrays.add("UInt8", "colour", 3, reinterpret_cast<const std::uint8_t*>(rgb.data()), 3 * n);
  text += arrays.add("UInt8", "material", 1, frame.materials.data(), n);
  text += arrays.add("UInt32", "identity", 1, frame.identities.data(), n);
  text += arrays.add("Float32", "speed", 1, frame.speeds.data(), n);
  text += "</PointData>\n<Points>\n" + arrays.add("Float32", "Points", 3, frame.positions.data(), 3 * n) +
          "</Points>\n<Verts>\n" + arrays.add("Int64", "connectivity", 1, vertices.data(), n) +
          arrays.add("Int64", "offsets", 1, ends.data(), n) +
          "</Verts>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_";
  return text + arrays.numbers() + "\n</AppendedData>\n</VTKFile>\n";
}

std::string pvd_of(const std::vector<std::pair<double, std::string>>& files) {
  std::string text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n";
  for (const auto& [time, file] : files)
    text += fmt::format("<DataSet timestep=\"{:.17g}\" file=\"{}\"/>\n", time, file);
  return text + "</Collection>\n</VTKFile>\n";
}

void export_points(const ExportOptions& options) {
  const RunFolder run = open_run(options.run);
  const std::vector<Colour> colours = colours_of(run.scene.materials, options.colours);
  const std::filesystem::path output = options.output.value_or(options.run / "export");
  const std::vector<std::size_t> frames = chosen_frames(options.frames, run.frame_count());
  make_writable_folder(output);
  const std::string made_by =
      fmt::format("made by {}, scene {}", version_line("talus"), run.scene.input_hash);
  const bool vtk = options.format == "vtk";
  std::vector<std::pair<double, std::string>> files;
  for (const std::size_t index : frames) {
    const std::string name = fmt::format("frame_{:06}.{}", index, vtk ? "vtp" : "ply");
    const RenderFrame frame = read_frame(run, index);
    write_file_atomically(output / name,
                          vtk ? vtp_of(frame, colours, made_by) : ply_of(frame, colours, made_by));
    files.emplace_back(frame.time, name);
    spdlog::info("{}: {} points, t = {:.4f} s", (output / name).string(), frame.count(), frame.time);
  }
  if (vtk) write_file_atomically(output / "render.pvd", pvd_of(files));
}

}  // namespace talus
