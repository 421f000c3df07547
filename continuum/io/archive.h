// Named numbers and lists, kept to the bit: what a checkpoint is made of. In memory a flat JSON object, in files CBOR, whose
// byte strings hold the lists as this machine has them.
//
// One description serves both ways: it calls number, list and group of the archive it is given, a writer, which takes the values,
// or a reader, which sets them.
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace talus {

static_assert(std::endian::native == std::endian::little, "archives are little-endian");

class ArchiveWriter {
 public:
  static constexpr bool reads = false;

  template <class Number>
  void number(std::string_view name, const Number& value) {
    fields_[prefix_ + std::string(name)] = value;
  }
  template <class List>
  void list(std::string_view name, const List& values) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(values.data());
    const auto size = sizeof(*values.data()) * static_cast<std::size_t>(values.size());
    fields_[prefix_ + std::string(name)] = nlohmann::json::binary({bytes, bytes + size});
  }
  /// What `content` writes has names that begin with "name/".
  template <class Content>
  void group(std::string_view name, const Content& content) {
    const std::string outer = std::exchange(prefix_, prefix_ + std::string(name) + "/");
    content();
    prefix_ = outer;
  }

  const nlohmann::json& fields() const { return fields_; }

 private:
  nlohmann::json fields_ = nlohmann::json::object();
  std::string prefix_;
};

/// Throws InputError, which names the file and the field, where a field is missing, of another kind or of another size.
class ArchiveReader {
 public:
  static constexpr bool reads = true;

  /// `fields` is referred to; `where`: the file, for errors.
  ArchiveReader(const nlohmann::json& fields, std::string where)
      : fields_(&fields), where_(std::move(where)) {}

  template <class Number>
  void number(std::string_view name, Number& value) {
    read_number(name, value);
  }
  /// Eigen's lists keep their rows, and take as many columns as there are; those of fixed size must find all of it.
  template <class List>
  void list(std::string_view name, List& values) {
    using Number = std::remove_reference_t<decltype(*values.data())>;
    const auto& bytes = field(name, nlohmann::json::value_t::binary).get_binary();
    const std::size_t row = sizeof(Number) * rows_of<List>();
    if (bytes.size() % row != 0) fail(name, "holds no whole number of entries");
    resize(values, bytes.size() / row, name);
    if (!bytes.empty()) std::memcpy(static_cast<void*>(values.data()), bytes.data(), bytes.size());
  }
  template <class Content>
  void group(std::string_view name, const Content& content) {
    const std::string outer = std::exchange(prefix_, prefix_ + std::string(name) + "/");
    content();
    prefix_ = outer;
  }
  bool has(std::string_view name) const { return fields_->contains(prefix_ + std::string(name)); }

  [[noreturn]] void fail(std::string_view name, std::string_view why) const;

 private:
  template <class List>
  static constexpr std::size_t rows_of() {
    if constexpr (requires { List::RowsAtCompileTime; })
      return List::RowsAtCompileTime == Eigen::Dynamic ? 1 : List::RowsAtCompileTime;
    else
      return 1;
  }
  template <class List>
  void resize(List& values, std::size_t entries, std::string_view name) const {
    if constexpr (requires { List::SizeAtCompileTime; }) {
      if constexpr (List::SizeAtCompileTime == Eigen::Dynamic) {
        if constexpr (List::RowsAtCompileTime == Eigen::Dynamic)
          values.resize(static_cast<Eigen::Index>(entries));
        else
          values.resize(List::RowsAtCompileTime, static_cast<Eigen::Index>(entries));
      } else if (entries * rows_of<List>() != static_cast<std::size_t>(values.size())) {
        fail(name, "is of the wrong size");
      }
    } else {
      values.resize(entries);
    }
  }
  const nlohmann::json& field(std::string_view name, nlohmann::json::value_t kind) const;
  void read_number(std::string_view name, bool& value) const;
  void read_number(std::string_view name, double& value) const;
  void read_number(std::string_view name, std::string& value) const;
  template <class Integer>
  requires std::is_integral_v<Integer>
  void read_number(std::string_view name, Integer& value) const {
    const std::int64_t wide = read_integer(name);
    value = static_cast<Integer>(wide);
    if (!std::in_range<Integer>(wide)) fail(name, "is beyond what this program can hold");
  }
  std::int64_t read_integer(std::string_view name) const;

  const nlohmann::json* fields_;
  std::string where_, prefix_;
};

/// `name` and a version on the first line, with the SHA-256 of all that follows: the fields.
std::string packed_archive(std::string_view name, int version, const nlohmann::json& fields);
/// The fields of such a text. Throws InputError, which names `where`, when it is not of that name and version, or not whole.
nlohmann::json unpacked_archive(std::string_view name, int version, std::string_view text,
                                const std::string& where);

}  // namespace talus
