// A table of numbers as comma-separated values, the names of its columns in the first line.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace talus::analysis {

class SnapshotError;

/// Reads some columns, row by row; others may stand among them, in any order.
class ColumnsReader {
 public:
  /// Throws SnapshotError naming the file: it is missing, or lacks a column.
  ColumnsReader(const std::filesystem::path& file, const std::vector<std::string_view>& columns);

  /// The next row's values in the order of `columns`; empty after the last. Throws SnapshotError naming file and line: a cell too many or too few, or one that
  /// is not a finite number.
  std::vector<double> next_row();

  /// What is wrong with the row that was read last.
  SnapshotError error(const std::string& what) const;

 private:
  bool next_line();
  double number(std::string_view cell) const;

  std::filesystem::path file_;
  std::ifstream in_;
  std::string line_;
  int number_ = 0;
  std::vector<std::size_t> places_;
  std::size_t width_ = 0;
};

}  // namespace talus::analysis
