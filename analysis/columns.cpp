#include "analysis/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "analysis/snapshot.h"

namespace talus::analysis {
namespace {

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    cells.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return cells;
}

}  // namespace

ColumnsReader::ColumnsReader(const std::filesystem::path& file, const std::vector<std::string_view>& columns)
    : file_(file), in_(file) {
  if (!in_) throw SnapshotError(fmt::format("{}: no such file", file.string()));
  next_line();
  const auto names = cells_of(line_);
  for (const auto column : columns) {
    const auto found = std::find(names.begin(), names.end(), column);
    if (found == names.end()) throw error(fmt::format("has no column {}", column));
    places_.push_back(static_cast<std::size_t>(found - names.begin()));
  }
  width_ = names.size();
}

std::vector<double> ColumnsReader::next_row() {
  if (!next_line()) return {};
  const auto cells = cells_of(line_);
  if (cells.size() != width_)
    throw error(fmt::format("has {} cells where {} belong; the file is damaged", cells.size(), width_));
  std::vector<double> values;
  for (const auto place : places_) values.push_back(number(cells[place]));
  return values;
}

SnapshotError ColumnsReader::error(const std::string& what) const {
  return SnapshotError(fmt::format("{}:{}: {}", file_.string(), number_, what));
}

bool ColumnsReader::next_line() {
  ++number_;
  return static_cast<bool>(std::getline(in_, line_));
}

double ColumnsReader::number(std::string_view cell) const {
  double value = 0.0;
  const auto [end, failure] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (failure != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
    throw error(fmt::format("'{}' is not a finite number", cell));
  return value;
}

}  // namespace talus::analysis
