#include "continuum/io/archive.h"

#include <fmt/format.h>

#include <limits>

#include "continuum/files/input_error.h"
#include "continuum/files/provenance.h"

namespace talus {
namespace {

/// Takes a flat object of numbers, texts and byte strings, and nothing else: a hostile file cannot nest.
class FlatObject : public nlohmann::json_sax<nlohmann::json> {
 public:
  explicit FlatObject(nlohmann::json& fields) : fields_(&fields) {}

  bool null() override { return false; }
  bool boolean(bool value) override { return set(value); }
  bool number_integer(std::int64_t value) override { return set(value); }
  bool number_unsigned(std::uint64_t value) override { return set(value); }
  bool number_float(double value, const std::string&) override { return set(value); }
  bool string(std::string& value) override { return set(std::move(value)); }
  bool binary(binary_t& value) override { return set(nlohmann::json::binary(std::move(value))); }
  bool start_object(std::size_t) override { return ++depth_ == 1; }
  bool key(std::string& name) override {
    name_ = std::move(name);
    return true;
  }
  bool end_object() override { return true; }
  bool start_array(std::size_t) override { return false; }
  bool end_array() override { return false; }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception&) override {
    return false;
  }

 private:
  template <class Value>
  bool set(Value&& value) {
    if (depth_ == 0) return false;
    (*fields_)[name_] = std::forward<Value>(value);
    return true;
  }

  nlohmann::json* fields_;
  std::string name_;
  int depth_ = 0;
};

std::string first_line(std::string_view name, int version, std::string_view content) {
  return fmt::format("{} {} sha256 {}\n", name, version, sha256(content));
}

}  // namespace

void ArchiveReader::fail(std::string_view name, std::string_view why) const {
  throw InputError(fmt::format("{}: field {}{} {}", where_, prefix_, name, why));
}

const nlohmann::json& ArchiveReader::field(std::string_view name, nlohmann::json::value_t kind) const {
  const auto found = fields_->find(prefix_ + std::string(name));
  if (found == fields_->end()) fail(name, "is missing");
  if (found->type() != kind) fail(name, "is of the wrong kind");
  return *found;
}

void ArchiveReader::read_number(std::string_view name, bool& value) const {
  value = field(name, nlohmann::json::value_t::boolean).get<bool>();
}

void ArchiveReader::read_number(std::string_view name, double& value) const {
  const auto found = fields_->find(prefix_ + std::string(name));
  if (found == fields_->end() || !found->is_number()) fail(name, "is missing, or no number");
  value = found->get<double>();
}

void ArchiveReader::read_number(std::string_view name, std::string& value) const {
  value = field(name, nlohmann::json::value_t::string).get<std::string>();
}

std::int64_t ArchiveReader::read_integer(std::string_view name) const {
  const auto found = fields_->find(prefix_ + std::string(name));
  if (found == fields_->end() || !found->is_number_integer()) fail(name, "is missing, or no whole number");
  if (found->is_number_unsigned() && found->get<std::uint64_t>() > std::numeric_limits<std::int64_t>::max())
    fail(name, "is beyond what this program can hold");
  return found->get<std::int64_t>();
}

std::string packed_archive(std::string_view name, int version, const nlohmann::json& fields) {
  std::string content;
  nlohmann::json::to_cbor(fields, content);
  return first_line(name, version, content) + content;
}

nlohmann::json unpacked_archive(std::string_view name, int version, std::string_view text,
                                const std::string& where) {
  const auto error = [&](std::string_view what) { return InputError(fmt::format("{}: {}", where, what)); };
  const std::string beginning = fmt::format("{} ", name);
  if (!text.starts_with(beginning)) throw error(fmt::format("not a file of ours (no {})", name));
  const auto end = text.substr(0, 256).find('\n');
  if (end == std::string_view::npos) throw error("not whole, or damaged: its first line does not end");
  if (const std::string right = fmt::format("{}{} ", beginning, version); !text.starts_with(right))
    throw error(fmt::format("of another version: \"{}\"; this program reads version {}", text.substr(0, end),
                            version));
  const std::string_view content = text.substr(end + 1);
  if (text.substr(0, end + 1) != first_line(name, version, content))
    throw error("not whole, or damaged: its content does not have the SHA-256 of its first line");
  nlohmann::json fields = nlohmann::json::object();
  FlatObject handler(fields);
  if (!nlohmann::json::sax_parse(content.begin(), content.end(), &handler,
                                 nlohmann::json::input_format_t::cbor))
    throw error("not whole, or damaged: no flat object in CBOR");
  return fields;
}

}  // namespace talus
