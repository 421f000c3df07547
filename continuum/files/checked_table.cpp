#include "continuum/files/checked_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <tuple>

#include "continuum/files/atomic_file.h"
#include "continuum/files/hostile_text.h"

namespace talus {

struct CheckedTable::Node {
  std::shared_ptr<const toml::table> root;  // keeps `table` alive
  const toml::table* table = nullptr;
  std::filesystem::path file;
  std::string prefix;                   // "geometry." for the keys of [geometry]
  mutable std::set<std::string> asked;  // every name this table may hold
};

namespace {

std::string value_text(const toml::node& node);

/// Not by toml++, which prints arrays of small numbers by way of undefined behaviour.
std::string array_text(const toml::array& array) {
  constexpr std::size_t most = 8;  // entries shown
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < std::min(array.size(), most); ++i) texts.push_back(value_text(array[i]));
  if (array.size() > most) texts.push_back("...");
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string value_text(const toml::node& node) {
  constexpr std::size_t longest = 200;  // characters
  std::ostringstream text;
  node.visit([&](const auto& n) {
    if constexpr (toml::is_table<decltype(n)>)
      text << "a table";
    else if constexpr (toml::is_array<decltype(n)>)
      text << array_text(n);
    else if constexpr (toml::is_floating_point<decltype(n)>)
      text << fmt::format("{}", n.get());  // as the user wrote it, not to 17 digits
    else
      text << n;
  });
  const std::string whole = text.str();
  return whole.size() > longest ? whole.substr(0, longest) + "..." : whole;
}

bool inside(double value, Range allowed) {
  return std::isfinite(value) && value >= allowed.low && value <= allowed.high;
}

std::string range_text(Range allowed) {
  const bool low = std::isfinite(allowed.low), high = std::isfinite(allowed.high);
  if (allowed.low == smallest_positive) {
    return high ? fmt::format("greater than 0 and at most {}", allowed.high) : "greater than 0";
  }
  if (low && high) return fmt::format("between {} and {}", allowed.low, allowed.high);
  if (low) return fmt::format("at least {}", allowed.low);
  if (high) return fmt::format("at most {}", allowed.high);
  return "any finite number";
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

std::optional<std::string> nearest_name(std::string_view wrong, const std::set<std::string>& names) {
  std::optional<std::string> best;
  std::size_t least = std::max<std::size_t>(2, wrong.size() / 3) + 1;
  for (const auto& name : names) {
    if (const auto distance = edit_distance(wrong, name); distance < least) {
      least = distance;
      best = name;
    }
  }
  return best;
}

CheckedTable::CheckedTable(std::unique_ptr<Node> node) : node_(std::move(node)) {}
CheckedTable::CheckedTable(CheckedTable&&) noexcept = default;
CheckedTable& CheckedTable::operator=(CheckedTable&&) noexcept = default;
CheckedTable::~CheckedTable() = default;

namespace {

constexpr std::uintmax_t largest_file = 10'000'000;  // bytes; far more than anyone writes

toml::table parse(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) {
    throw InputError(fmt::format("{}: no such file; give the path of a TOML file", file.string()));
  }
  std::error_code unknown;  // read_file tells of files that cannot be read
  if (const auto size = std::filesystem::file_size(file, unknown); !unknown && size > largest_file) {
    throw InputError(fmt::format("{}: has {:.0f} MB; at most {:.0f}", file.string(),
                                 static_cast<double>(size) / 1e6, static_cast<double>(largest_file) / 1e6));
  }
  const std::string text = read_file(file);
  refuse_hostile_text(file, text);
  try {
    return toml::parse(text, file.string());
  } catch (const toml::parse_error& bad) {
    throw InputError(
        fmt::format("{}:{}: not valid TOML: {}", file.string(), bad.source().begin.line, bad.description()));
  }
}

/// Nodes are moved, not copied: a copy would forget its line in the file.
void lay_over(toml::table& base, toml::table&& over) {
  for (auto&& [key, value] : over) {
    auto* below = base.get_as<toml::table>(key.str());
    if (below && value.is_table()) {
      lay_over(*below, std::move(*value.as_table()));
    } else {
      value.visit([&, name = key.str()](auto& node) { base.insert_or_assign(name, std::move(node)); });
    }
  }
}

}  // namespace

CheckedTable CheckedTable::parse_file(const std::filesystem::path& file) {
  const auto root = std::make_shared<const toml::table>(parse(file));
  return CheckedTable(std::make_unique<Node>(Node{root, root.get(), file, {}, {}}));
}

std::vector<std::string> CheckedTable::point_names(const std::filesystem::path& file) {
  const CheckedTable root = parse_file(file);
  std::vector<std::string> names;
  if (!root.has("point")) return names;
  for (const CheckedTable& point : root.tables("point")) {
    names.push_back(point.string("name"));
    if (std::count(names.begin(), names.end(), names.back()) > 1)
      throw point.error("name", "is given twice; give each point once");
  }
  return names;
}

CheckedTable CheckedTable::parse_point(const std::filesystem::path& file, std::string_view point) {
  const auto names = point_names(file);
  auto root = std::make_shared<toml::table>(parse(file));
  if (!point.empty()) {
    const auto place = std::find(names.begin(), names.end(), point);
    if (place == names.end()) {
      throw InputError(fmt::format("{}: has no [[point]] with name = '{}'; there are: {}", file.string(),
                                   point, fmt::join(names, ", ")));
    }
    toml::table over = std::move(*root->get("point")->as_array()->get(place - names.begin())->as_table());
    over.erase("name");
    lay_over(*root, std::move(over));
  }
  root->erase("point");
  return CheckedTable(std::make_unique<Node>(Node{root, root.get(), file, {}, {}}));
}

const std::filesystem::path& CheckedTable::file() const { return node_->file; }

bool CheckedTable::has(std::string_view key) const {
  node_->asked.emplace(key);
  return node_->table->contains(key);
}

InputError CheckedTable::error(std::string_view key, std::string_view why) const {
  const toml::node* value = node_->table->get(key);
  const auto line = value ? value->source().begin.line : node_->table->source().begin.line;
  const std::string shown = value ? fmt::format(" = {}", value_text(*value)) : std::string();
  return InputError(
      fmt::format("{}:{}: key '{}{}'{}: {}", node_->file.string(), line, node_->prefix, key, shown, why));
}

InputError CheckedTable::missing(std::string_view key, std::string_view what) const {
  std::set<std::string> strangers;  // present, but nobody has asked for them so far
  for (const auto& [name, value] : *node_->table) {
    if (!node_->asked.contains(std::string(name.str()))) strangers.emplace(name.str());
  }
  const auto meant = nearest_name(key, strangers);
  return error(key, fmt::format("is missing; {}{}", what,
                                meant ? fmt::format("; the file has '{}' instead", *meant) : ""));
}

namespace {

template <class T>
constexpr std::string_view type_name() {
  if constexpr (std::is_same_v<T, std::string>)
    return "text in quotes";
  else if constexpr (std::is_same_v<T, double>)
    return "a number";
  else
    return "a whole number";
}

}  // namespace

double CheckedTable::number(std::string_view key, Range allowed) const {
  if (!has(key)) throw missing(key, fmt::format("it must be a number, {}", range_text(allowed)));
  const auto value = node_->table->get(key)->value<double>();
  if (!value || !node_->table->get(key)->is_number()) {
    throw error(key, fmt::format("must be a number, {}", range_text(allowed)));
  }
  if (!inside(*value, allowed)) throw error(key, fmt::format("must be {}", range_text(allowed)));
  return *value;
}

double CheckedTable::number(std::string_view key, Range allowed, double otherwise) const {
  return has(key) ? number(key, allowed) : otherwise;
}

std::int64_t CheckedTable::integer(std::string_view key, std::int64_t low, std::int64_t high) const {
  const std::string allowed = fmt::format("a whole number between {} and {}", low, high);
  if (!has(key)) throw missing(key, "it must be " + allowed);
  const auto* value = node_->table->get(key)->as_integer();
  if (!value || value->get() < low || value->get() > high) throw error(key, "must be " + allowed);
  return value->get();
}

std::int64_t CheckedTable::integer(std::string_view key, std::int64_t low, std::int64_t high,
                                   std::int64_t otherwise) const {
  return has(key) ? integer(key, low, high) : otherwise;
}

std::string CheckedTable::string(std::string_view key) const {
  if (!has(key)) throw missing(key, "it must be text in quotes");
  const auto* value = node_->table->get(key)->as_string();
  if (!value) throw error(key, "must be text in quotes");
  return value->get();
}

std::string CheckedTable::string(std::string_view key, std::string_view otherwise) const {
  return has(key) ? string(key) : std::string(otherwise);
}

std::string CheckedTable::choice(std::string_view key, std::span<const std::string_view> allowed) const {
  std::string value = string(key);
  if (std::find(allowed.begin(), allowed.end(), value) == allowed.end()) {
    const auto meant = nearest_name(value, std::set<std::string>(allowed.begin(), allowed.end()));
    throw error(key, fmt::format("must be one of: {}{}", fmt::join(allowed, ", "),
                                 meant ? fmt::format("; did you mean '{}'?", *meant) : ""));
  }
  return value;
}

bool CheckedTable::boolean(std::string_view key, bool otherwise) const {
  if (!has(key)) return otherwise;
  const auto* value = node_->table->get(key)->as_boolean();
  if (!value) throw error(key, "must be true or false");
  return value->get();
}

namespace {

template <class T, class Table>
std::vector<T> read_array(const Table& table, const toml::array* array, std::string_view key) {
  std::vector<T> values;
  for (const auto& element : *array) {
    const auto value = element.template value<T>();
    const bool right_type = std::is_same_v<T, double>        ? element.is_number()
                            : std::is_same_v<T, std::string> ? element.is_string()
                                                             : element.is_integer();
    if (!value || !right_type) throw table.error(key, fmt::format("each entry must be {}", type_name<T>()));
    values.push_back(*value);
  }
  return values;
}

}  // namespace

Eigen::Vector3d CheckedTable::vector(std::string_view key, Range allowed) const {
  if (!has(key)) throw missing(key, "it must be three numbers, [x, y, z]");
  const auto* array = node_->table->get(key)->as_array();
  if (!array || array->size() != 3) throw error(key, "must be three numbers, [x, y, z]");
  const auto values = read_array<double>(*this, array, key);
  for (const double value : values) {
    if (!inside(value, allowed)) throw error(key, fmt::format("each entry must be {}", range_text(allowed)));
  }
  return {values[0], values[1], values[2]};
}

std::vector<Eigen::Vector2d> CheckedTable::pairs(std::string_view key, Range first, Range second) const {
  if (!has(key)) throw missing(key, "it must be a list of pairs of numbers, [[a, b], ...]");
  const auto* array = node_->table->get(key)->as_array();
  if (!array || array->empty()) throw error(key, "must be a list of pairs of numbers, [[a, b], ...]");
  std::vector<Eigen::Vector2d> found;
  for (const auto& element : *array) {
    const auto* pair = element.as_array();
    if (!pair || pair->size() != 2) throw error(key, "each entry must be a pair of numbers, [a, b]");
    const auto values = read_array<double>(*this, pair, key);
    for (const auto& [value, allowed, which] :
         {std::tuple(values[0], first, "first"), std::tuple(values[1], second, "second")}) {
      if (!inside(value, allowed))
        throw error(key, fmt::format("the {} number of each pair must be {}", which, range_text(allowed)));
    }
    found.emplace_back(values[0], values[1]);
  }
  return found;
}

Eigen::Vector3i CheckedTable::integer_vector(std::string_view key, int low, int high) const {
  const std::string allowed = fmt::format("three whole numbers between {} and {}, [x, y, z]", low, high);
  if (!has(key)) throw missing(key, "it must be " + allowed);
  const auto* array = node_->table->get(key)->as_array();
  if (!array || array->size() != 3) throw error(key, "must be " + allowed);
  const auto values = read_array<std::int64_t>(*this, array, key);
  for (const auto value : values) {
    if (value < low || value > high) throw error(key, "must be " + allowed);
  }
  return {static_cast<int>(values[0]), static_cast<int>(values[1]), static_cast<int>(values[2])};
}

std::vector<std::int64_t> CheckedTable::integers(std::string_view key, std::int64_t low, std::int64_t high,
                                                 bool may_be_empty) const {
  const std::string allowed = fmt::format("whole numbers between {} and {}", low, high);
  if (!has(key)) throw missing(key, "it must be a list of " + allowed);
  const auto* array = node_->table->get(key)->as_array();
  if (!array || (array->empty() && !may_be_empty))
    throw error(key, fmt::format("must be a list of {}", allowed));
  auto values = read_array<std::int64_t>(*this, array, key);
  const bool in_range =
      std::all_of(values.begin(), values.end(), [&](auto v) { return v >= low && v <= high; });
  if (!in_range) throw error(key, "must hold " + allowed);
  if (std::set(values.begin(), values.end()).size() != values.size())
    throw error(key, "must not repeat an entry");
  return values;
}

std::vector<std::string> CheckedTable::strings(std::string_view key) const {
  if (!has(key)) throw missing(key, "it must be a list of texts in quotes");
  const auto* array = node_->table->get(key)->as_array();
  if (!array || array->empty()) throw error(key, "must be a list of texts in quotes");
  return read_array<std::string>(*this, array, key);
}

CheckedTable CheckedTable::table(std::string_view key) const {
  if (!has(key)) throw missing(key, fmt::format("the file needs a table [{}{}]", node_->prefix, key));
  const auto* table = node_->table->get(key)->as_table();
  if (!table) throw error(key, fmt::format("must be a table, [{}{}]", node_->prefix, key));
  return CheckedTable(std::make_unique<Node>(
      Node{node_->root, table, node_->file, fmt::format("{}{}.", node_->prefix, key), {}}));
}

std::optional<CheckedTable> CheckedTable::optional_table(std::string_view key) const {
  if (!has(key)) return std::nullopt;
  return table(key);
}

std::vector<CheckedTable> CheckedTable::tables(std::string_view key) const {
  if (!has(key)) throw missing(key, fmt::format("the file needs at least one [[{}{}]]", node_->prefix, key));
  const auto* array = node_->table->get(key)->as_array();
  if (!array || array->empty() || !array->is_homogeneous(toml::node_type::table)) {
    throw error(key, fmt::format("the file needs at least one [[{}{}]]", node_->prefix, key));
  }
  std::vector<CheckedTable> found;
  for (std::size_t i = 0; i < array->size(); ++i) {
    found.push_back(CheckedTable(std::make_unique<Node>(Node{node_->root,
                                                             array->get(i)->as_table(),
                                                             node_->file,
                                                             fmt::format("{}{}[{}].", node_->prefix, key, i),
                                                             {}})));
  }
  return found;
}

std::vector<std::pair<std::string, CheckedTable>> CheckedTable::named_tables() const {
  std::vector<std::pair<std::string, CheckedTable>> found;
  for (const auto& [key, value] : *node_->table) {
    if (value.is_table()) found.emplace_back(std::string(key.str()), table(key.str()));
  }
  return found;
}

void CheckedTable::require_schema(std::int64_t version) const {
  if (!has("schema")) throw missing("schema", fmt::format("the file must say schema = {}", version));
  if (integer("schema", 1, 1'000'000) != version) {
    throw error("schema", fmt::format("this program reads schema {}", version));
  }
}

void CheckedTable::finish() const {
  for (const auto& [key, value] : *node_->table) {
    const std::string name(key.str());
    if (node_->asked.contains(name)) continue;
    const auto meant = nearest_name(name, node_->asked);
    throw error(name, fmt::format("is not a key of this file{}; allowed here: {}",
                                  meant ? fmt::format("; did you mean '{}'?", *meant) : std::string(),
                                  fmt::join(node_->asked, ", ")));
  }
}

}  // namespace talus
