// Walks a text dump in the format of LAMMPS; not for other code than the readers of such dumps.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <string>
#include <string_view>

#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"

namespace talus::dem {

/// Walks a dump line by line and tells where it is when something is wrong.
class DumpReader {
 public:
  DumpReader(std::filesystem::path file) : file_(std::move(file)), text_(read_file(file_)) {}

  bool at_end() const { return position_ >= text_.size(); }

  std::string_view line() {
    const auto end = text_.find('\n', position_);
    if (end == std::string::npos)
      throw error("the file ends in the middle of a snapshot: the run did not finish; run it again");
    const std::string_view found(text_.data() + position_, end - position_);
    position_ = end + 1;
    ++line_number_;
    return found;
  }

  void expect(std::string_view heading) {
    const auto found = line();
    if (!found.starts_with(heading))
      throw error(fmt::format("'{}' where '{}' belongs; the file is damaged", found, heading));
  }

  template <class Number>
  Number next(std::string_view& rest) {
    rest.remove_prefix(std::min(rest.find_first_not_of(' '), rest.size()));
    Number value{};
    const auto [end, failure] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (failure != std::errc())
      throw error(fmt::format("'{}' where a number belongs; the file is damaged", rest));
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    return value;
  }

  template <class Number>
  Number number_line() {
    auto rest = line();
    return next<Number>(rest);
  }

  InputError error(std::string_view why) const {
    return InputError(fmt::format("{}:{}: {}", file_.string(), line_number_, why));
  }

 private:
  std::filesystem::path file_;
  std::string text_;
  std::size_t position_ = 0;
  std::size_t line_number_ = 0;
};

}  // namespace talus::dem
