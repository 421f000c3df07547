#include "continuum/files/hostile_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "continuum/files/input_error.h"

namespace talus {
namespace {

constexpr int most_key_parts = 32;  // of a dotted key

/// TOML has no place for them, and whoever hands over a binary file is better told so than what key it begins with.
void refuse_control_characters(const std::filesystem::path& file, std::string_view text) {
  const auto found = std::ranges::find_if(
      text, [](unsigned char c) { return (c < 0x20 && c != '\t' && c != '\n' && c != '\r') || c == 0x7f; });
  if (found == text.end()) return;
  throw InputError(fmt::format(
      "{}:{}: not valid TOML: holds the control character 0x{:02x}; is it a text file?", file.string(),
      1 + std::count(text.begin(), found, '\n'), static_cast<unsigned char>(*found)));
}

/// Where a text that begins with quotes goes on behind them, as TOML has it; at the end of its line where they are not closed.
std::size_t end_of_quotes(std::string_view text) {
  const char quote = text[0];
  const std::string three(3, quote);
  const bool many_lines = text.starts_with(three);
  std::size_t at = many_lines ? 3 : 1;
  for (; at < text.size(); ++at) {
    if (text[at] == '\\' && quote == '"')
      ++at;
    else if (many_lines ? text.substr(at).starts_with(three) : text[at] == quote)
      return at + (many_lines ? 3 : 1);
    else if (text[at] == '\n' && !many_lines)
      break;
  }
  return std::min(at, text.size());
}

/// Each part of a key is a table in the one before: toml++ takes them apart by recursion, and the stack is not that deep.
void refuse_long_keys(const std::filesystem::path& file, std::string_view text) {
  int dots = 0;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (c == '"' || c == '\'') {
      at += end_of_quotes(text.substr(at));
      continue;
    }
    if (c == '#') {
      at = std::min(text.find('\n', at), text.size());
      continue;
    }
    if (std::string_view("=,[]{}\n").find(c) != std::string_view::npos) dots = 0;
    if (c == '.' && ++dots >= most_key_parts) {
      throw InputError(fmt::format("{}:{}: not valid here: a key of more than {} parts", file.string(),
                                   1 + std::ranges::count(text.substr(0, at), '\n'), most_key_parts));
    }
    ++at;
  }
}

}  // namespace

void refuse_hostile_text(const std::filesystem::path& file, std::string_view text) {
  refuse_control_characters(file, text);
  refuse_long_keys(file, text);
}

}  // namespace talus
