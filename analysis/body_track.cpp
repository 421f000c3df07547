#include "analysis/body_track.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>

#include "analysis/snapshot.h"

namespace talus::analysis {
namespace {

constexpr std::array<std::string_view, 7> columns{"time_s", "x_m",    "y_m",   "z_m",
                                                  "vx_m_s", "vy_m_s", "vz_m_s"};

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    cells.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return cells;
}

/// Walks the file and tells where it is when something is wrong.
class TrackReader {
 public:
  explicit TrackReader(const std::filesystem::path& file) : file_(file), in_(file) {
    if (!in_) throw SnapshotError(fmt::format("{}: no such file", file.string()));
    next_line();
    const auto names = cells_of(line_);
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const auto found = std::find(names.begin(), names.end(), columns[k]);
      if (found == names.end()) throw error(fmt::format("has no column {}", columns[k]));
      places_[k] = static_cast<std::size_t>(found - names.begin());
    }
    width_ = names.size();
  }

  bool next_line() {
    ++number_;
    return static_cast<bool>(std::getline(in_, line_));
  }

  BodyMoment moment() const {
    const auto cells = cells_of(line_);
    if (cells.size() != width_)
      throw error(fmt::format("has {} cells where {} belong; the file is damaged", cells.size(), width_));
    std::array<double, columns.size()> v{};
    for (std::size_t k = 0; k < columns.size(); ++k) v[k] = number(cells[places_[k]]);
    return {v[0], {v[1], v[2], v[3]}, {v[4], v[5], v[6]}};
  }

  SnapshotError error(const std::string& what) const {
    return SnapshotError(fmt::format("{}:{}: {}", file_.string(), number_, what));
  }

 private:
  double number(std::string_view cell) const {
    double value = 0.0;
    const auto [end, failure] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (failure != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
      throw error(fmt::format("'{}' is not a finite number", cell));
    return value;
  }

  std::filesystem::path file_;
  std::ifstream in_;
  std::string line_;
  int number_ = 0;
  std::array<std::size_t, columns.size()> places_{};
  std::size_t width_ = 0;
};

}  // namespace

BodyTrack read_body_track(const std::filesystem::path& file) {
  TrackReader reader(file);
  BodyTrack track;
  while (reader.next_line()) {
    track.push_back(reader.moment());
    if (track.size() > 1 && track.back().time <= track[track.size() - 2].time)
      throw reader.error("the time does not increase: a second body, or a damaged file");
  }
  if (track.empty()) throw SnapshotError(fmt::format("{}: holds no row", file.string()));
  return track;
}

}  // namespace talus::analysis
