#include "continuum/solids/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"

namespace talus {
namespace {

constexpr std::size_t stl_header = 84,
                      stl_triangle = 50;   // bytes: 80 of free text and a count; normal, corners, 2 unused
constexpr std::size_t most_corners = 100;  // of a face

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

/// Text by lines, each cut into words.
class Lines {
 public:
  Lines(const std::filesystem::path& file, std::string_view text) : file_(file), rest_(text) {}

  /// Steps to the next line that holds a word; false at the end. A backslash at the end of a line joins it to the next.
  bool next() {
    words_.clear();
    while (words_.empty() && !rest_.empty()) {
      bool joined = true;
      while (joined && !rest_.empty()) joined = add_line();
    }
    return !words_.empty();
  }
  const std::vector<std::string_view>& words() const { return words_; }

  InputError error(std::string_view why) const {
    return InputError(fmt::format("{}:{}: cannot be read as a mesh: {}; export it again as STL or OBJ",
                                  file_.string(), number_, why));
  }

  /// Of words from `first` on: a point in single precision.
  Eigen::Vector3f point(std::size_t first) const {
    if (words_.size() < first + 3) throw error(fmt::format("'{}' needs three numbers", words_.front()));
    return {coordinate(words_[first]), coordinate(words_[first + 1]), coordinate(words_[first + 2])};
  }

 private:
  /// Adds the words of a line; returns whether the next one belongs to it.
  bool add_line() {
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++number_;
    constexpr std::string_view blanks = " \t\r\v\f";
    line = line.substr(0, line.find_last_not_of(blanks) + 1);
    const bool joined = line.ends_with('\\');
    if (joined) line.remove_suffix(1);
    for (std::size_t at = line.find_first_not_of(blanks); at < line.size();
         at = line.find_first_not_of(blanks, at)) {
      const std::size_t stop = std::min(line.find_first_of(blanks, at), line.size());
      words_.push_back(line.substr(at, stop - at));
      at = stop;
    }
    return joined;
  }

  float coordinate(std::string_view word) const {
    const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
    double value = 0.0;
    const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (fault != std::errc() || end != digits.data() + digits.size())
      throw error(fmt::format("'{}' is no number", word));
    return static_cast<float>(value);
  }

  std::filesystem::path file_;
  std::string_view rest_;
  std::vector<std::string_view> words_;
  int number_ = 0;
};

void add_triangle(const std::filesystem::path& file, const std::array<std::size_t, 3>& corners,
                  TriangleSoup& soup) {
  if (soup.triangles.size() == most_triangles) {
    throw InputError(
        fmt::format("{}: has more than {} triangles; simplify it in a mesh editor: the grid sees nothing "
                    "finer than a cell",
                    file.string(), most_triangles));
  }
  soup.triangles.push_back(corners);
}

/// Of the last three points.
void add_last_triangle(const std::filesystem::path& file, TriangleSoup& soup) {
  const std::size_t n = soup.points.size();
  add_triangle(file, {n - 3, n - 2, n - 1}, soup);
}

TriangleSoup read_text_stl(const std::filesystem::path& file, std::string_view text) {
  TriangleSoup soup;
  Lines lines(file, text);
  bool in_facet = false, ended = false;
  std::size_t corners = 0;
  while (lines.next()) {
    const std::string word = lower_case(lines.words().front());
    const bool vertex = word == "vertex", facet = word == "facet", end_facet = word == "endfacet";
    if (vertex) {
      if (!in_facet || ++corners > 3) throw lines.error("a vertex beside the three of a facet");
      soup.points.push_back(lines.point(1));
    } else if (facet || end_facet) {
      if (facet == in_facet) throw lines.error(fmt::format("'{}' where none can be", word));
      if (end_facet && corners != 3) throw lines.error("a facet without three vertices");
      if (end_facet) add_last_triangle(file, soup);
      in_facet = facet;
      corners = 0;
    } else if (word == "solid" || word == "endsolid") {
      if (in_facet) throw lines.error("a facet has no end");
      ended = word == "endsolid";
    } else if (word != "outer" && word != "endloop") {
      throw lines.error(fmt::format("'{}' is no word of STL", lines.words().front()));
    }
  }
  if (!ended) throw lines.error("ends before 'endsolid'");
  return soup;
}

TriangleSoup read_binary_stl(const std::filesystem::path& file, std::string_view bytes) {
  TriangleSoup soup;
  for (std::size_t at = stl_header; at < bytes.size(); at += stl_triangle) {
    std::array<float, 12> numbers;  // the normal first: corners tell it again
    std::memcpy(numbers.data(), bytes.data() + at, sizeof numbers);
    for (std::size_t corner = 3; corner < 12; corner += 3)
      soup.points.emplace_back(numbers[corner], numbers[corner + 1], numbers[corner + 2]);
    add_last_triangle(file, soup);
  }
  return soup;
}

TriangleSoup read_stl(const std::filesystem::path& file, std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() >= stl_header) std::memcpy(&count, bytes.data() + stl_header - sizeof count, sizeof count);
  // Some write "solid" into the free text of binary files, so size decides.
  if (bytes.size() >= stl_header && bytes.size() == stl_header + stl_triangle * count)
    return read_binary_stl(file, bytes);
  if (lower_case(bytes.substr(0, 5)) == "solid") return read_text_stl(file, bytes);
  throw InputError(
      fmt::format("{}: cannot be read as a mesh: no STL text, which begins with 'solid', nor binary STL: {} "
                  "bytes are not 84 and 50 for "
                  "each of the {} triangles that it claims; it may be cut off; export it again as STL or OBJ",
                  file.string(), bytes.size(), count));
}

/// Corners of a face: numbers into soup.points; those that count from the end become such.
std::vector<std::int64_t> face_corners(const Lines& lines, const TriangleSoup& soup) {
  std::vector<std::int64_t> corners;
  for (std::size_t w = 1; w < lines.words().size(); ++w) {
    const std::string_view word = lines.words()[w].substr(0, lines.words()[w].find('/'));
    std::int64_t number = 0;
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), number);
    const auto there = static_cast<std::int64_t>(soup.points.size());
    if (fault != std::errc() || end != word.data() + word.size() || number == 0 || number > there ||
        number < -there)
      throw lines.error(fmt::format("'{}' names none of the {} vertices before it", lines.words()[w], there));
    corners.push_back(number > 0 ? number - 1 : there + number);
  }
  return corners;
}

/// Triangles from one corner to all edges that do not touch it; nothing unless all face the same way as the polygon.
std::optional<std::vector<std::array<std::size_t, 3>>> fan(const std::vector<std::int64_t>& corners,
                                                           std::size_t apex,
                                                           const std::vector<Eigen::Vector3d>& at) {
  const std::size_t n = corners.size();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < n; ++i) normal += at[i].cross(at[(i + 1) % n]);
  std::vector<std::array<std::size_t, 3>> triangles;
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const std::size_t b = (apex + i) % n, c = (apex + i + 1) % n;
    if (!((at[b] - at[apex]).cross(at[c] - at[apex]).dot(normal) > 0.0)) return std::nullopt;
    triangles.push_back({static_cast<std::size_t>(corners[apex]), static_cast<std::size_t>(corners[b]),
                         static_cast<std::size_t>(corners[c])});
  }
  return triangles;
}

void add_face(const std::filesystem::path& file, const Lines& lines, TriangleSoup& soup) {
  const auto corners = face_corners(lines, soup);
  if (corners.size() < 3 || corners.size() > most_corners)
    throw lines.error(
        fmt::format("a face has {} corners; 3 to {} are allowed", corners.size(), most_corners));
  if (corners.size() == 3) {
    add_triangle(file,
                 {static_cast<std::size_t>(corners[0]), static_cast<std::size_t>(corners[1]),
                  static_cast<std::size_t>(corners[2])},
                 soup);
    return;
  }
  std::vector<Eigen::Vector3d> at;
  for (const auto corner : corners)
    at.push_back(
        (soup.points[static_cast<std::size_t>(corner)] - soup.points[static_cast<std::size_t>(corners[0])])
            .cast<double>());
  for (std::size_t apex = 0; apex < corners.size(); ++apex) {
    const auto triangles = fan(corners, apex, at);
    if (!triangles) continue;
    for (const auto& triangle : *triangles) add_triangle(file, triangle, soup);
    return;
  }
  throw lines.error(fmt::format(
      "a face has {} corners, from none of which it is seen whole; triangulate it in a mesh editor",
      corners.size()));
}

TriangleSoup read_obj(const std::filesystem::path& file, std::string_view text) {
  // Of no concern here: texture, normals, names, groups, smoothing, materials.
  static const std::set<std::string_view> passed_over{"vt", "vn", "vp",     "o",     "g",
                                                      "s",  "mg", "usemtl", "mtllib"};
  TriangleSoup soup;
  Lines lines(file, text);
  while (lines.next()) {
    const std::string_view word = lines.words().front();
    if (word.starts_with('#') || passed_over.contains(word)) continue;
    if (word == "v")
      soup.points.push_back(lines.point(1));
    else if (word == "f")
      add_face(file, lines, soup);
    else if (word == "l" || word == "p")
      throw lines.error("has lines or points beside its triangles; export the surface alone");
    else
      throw lines.error(fmt::format("'{}' is no word of an OBJ file with vertices and faces", word));
  }
  return soup;
}

}  // namespace

TriangleSoup read_triangles_of_file(const std::filesystem::path& file) {
  const std::string extension = lower_case(file.extension().string());
  if (extension != ".stl" && extension != ".obj")
    throw InputError(
        fmt::format("{}: is no mesh that can be read here; give an .stl or .obj file", file.string()));
  if (!std::filesystem::is_regular_file(file))
    throw InputError(fmt::format("{}: no such file; give the path of an .stl or .obj file", file.string()));
  std::error_code unknown;  // read_file tells of files that cannot be read
  const auto size = static_cast<double>(std::filesystem::file_size(file, unknown));
  if (!unknown && size > largest_mesh_file) {
    throw InputError(fmt::format("{}: has {:.0f} MB; at most {:.0f}; simplify it in a mesh editor",
                                 file.string(), size / 1e6, largest_mesh_file / 1e6));
  }
  const std::string bytes = read_file(file);
  return extension == ".stl" ? read_stl(file, bytes) : read_obj(file, bytes);
}

}  // namespace talus
