// A TOML table that is read strictly: every key is asked for by name, type and range, and every key that
// nobody asked for is an error. One reader for scenes, cases, calibrations and suites, so that bad input
// is told in one voice: file, line, key, value, what is allowed, and the nearest right name for a typo.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "continuum/files/input_error.h"

namespace talus {

/// The closed interval [low, high] a number must lie in, in the unit that its key names.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

inline constexpr double smallest_positive = std::numeric_limits<double>::min();
inline constexpr Range positive{smallest_positive};
inline constexpr Range non_negative{0.0};

class CheckedTable {
 public:
  /// Reads a whole file. Throws InputError when it cannot be opened or is not TOML.
  static CheckedTable parse_file(const std::filesystem::path& file);
  /// The same with the keys of one of the file's tables [[point]], the one with `name = point`, laid over its own; the tables
  /// [[point]] themselves are then gone, and so they are for an empty `point`. Throws InputError that names the
  /// points there are.
  static CheckedTable parse_point(const std::filesystem::path& file, std::string_view point);
  /// Names of the tables [[point]] of a file, in its order. Throws InputError for one without a name, or twice.
  static std::vector<std::string> point_names(const std::filesystem::path& file);

  CheckedTable(CheckedTable&&) noexcept;
  CheckedTable& operator=(CheckedTable&&) noexcept;
  ~CheckedTable();

  // Each of these throws InputError when the key is missing (those without a default), has another type,
  // or lies outside what is allowed.
  double number(std::string_view key, Range allowed = {}) const;
  double number(std::string_view key, Range allowed, double otherwise) const;
  std::int64_t integer(std::string_view key, std::int64_t low, std::int64_t high) const;
  std::int64_t integer(std::string_view key, std::int64_t low, std::int64_t high,
                       std::int64_t otherwise) const;
  std::string string(std::string_view key) const;
  std::string string(std::string_view key, std::string_view otherwise) const;
  /// One of `allowed`.
  std::string choice(std::string_view key, std::span<const std::string_view> allowed) const;
  bool boolean(std::string_view key, bool otherwise) const;
  Eigen::Vector3d vector(std::string_view key, Range allowed = {}) const;
  /// A list of pairs of numbers, [[a, b], ...]; at least one.
  std::vector<Eigen::Vector2d> pairs(std::string_view key, Range first = {}, Range second = {}) const;
  /// Three whole numbers, [x, y, z].
  Eigen::Vector3i integer_vector(std::string_view key, int low, int high) const;
  /// A list without repeats; with at least one entry, unless it `may_be_empty`.
  std::vector<std::int64_t> integers(std::string_view key, std::int64_t low, std::int64_t high,
                                     bool may_be_empty = false) const;
  std::vector<std::string> strings(std::string_view key) const;
  CheckedTable table(std::string_view key) const;
  std::optional<CheckedTable> optional_table(std::string_view key) const;
  /// An array of tables, [[key]]; at least one.
  std::vector<CheckedTable> tables(std::string_view key) const;
  /// The tables [name.key] under this one, with their keys; for tables whose keys are free names.
  std::vector<std::pair<std::string, CheckedTable>> named_tables() const;
  /// `schema = version`, the first thing every file of ours says.
  void require_schema(std::int64_t version) const;
  bool has(std::string_view key) const;

  /// Call when everything has been asked for: throws InputError on the first key that was not.
  void finish() const;

  /// An InputError about one key of this table: "FILE:LINE: key 'a.b' = VALUE: WHY".
  [[nodiscard]] InputError error(std::string_view key, std::string_view why) const;

  const std::filesystem::path& file() const;

 private:
  struct Node;
  /// An InputError that says `key` is missing and names the key that may have been meant.
  InputError missing(std::string_view key, std::string_view what) const;
  explicit CheckedTable(std::unique_ptr<Node> node);
  std::unique_ptr<Node> node_;
};

/// The name of `names` that is nearest to `wrong` by edit distance, if one is near enough to be meant.
std::optional<std::string> nearest_name(std::string_view wrong, const std::set<std::string>& names);

}  // namespace talus
