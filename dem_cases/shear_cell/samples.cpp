#include "dem_cases/shear_cell/samples.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "continuum/files/input_error.h"

namespace talus::dem {
namespace {

std::vector<std::string> words_of(std::string_view line) {
  std::istringstream in{std::string(line)};
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

double number_of(const std::string& word, const std::string& where) {
  std::size_t used = 0;
  double value;
  try {
    value = std::stod(word, &used);
  } catch (const std::exception&) {
    value = std::nan("");
  }
  if (used != word.size() || !std::isfinite(value))
    throw InputError(fmt::format("{}: '{}' is not a finite number", where, word));
  return value;
}

}  // namespace

std::map<std::string, std::vector<double>> read_samples(const std::filesystem::path& file,
                                                        const SampleExpectation& expected) {
  std::ifstream in(file);
  if (!in) throw InputError(fmt::format("{}: cannot be opened; the run wrote no samples", file.string()));
  const auto names = words_of(expected.columns);
  std::map<std::string, std::vector<double>> columns;
  std::string line;
  if (!std::getline(in, line) || words_of(line) != names)
    throw InputError(fmt::format("{}:1: must be the column names '{}'", file.string(), expected.columns));
  std::int64_t count = 0;
  while (std::getline(in, line)) {
    ++count;
    const std::string where = fmt::format("{}:{}", file.string(), count + 1);
    const auto words = words_of(line);
    if (words.size() != names.size()) {
      throw InputError(
          fmt::format("{}: has {} numbers instead of {}; the run did not finish or the file is damaged",
                      where, words.size(), names.size()));
    }
    for (std::size_t i = 0; i < names.size(); ++i) columns[names[i]].push_back(number_of(words[i], where));
    const double step = columns["step"].back();
    if (step != static_cast<double>(count * expected.steps_per_sample))
      throw InputError(
          fmt::format("{}: is of step {} instead of {}", where, step, count * expected.steps_per_sample));
    const double grains = columns["grains"].back();
    if (grains != static_cast<double>(expected.sphere_count))
      throw InputError(fmt::format("{}: has {} grains instead of {}; grains were lost", where, grains,
                                   expected.sphere_count));
  }
  if (count * expected.steps_per_sample != expected.step_count) {
    throw InputError(fmt::format("{}: ends at step {} instead of {}; the run did not finish", file.string(),
                                 count * expected.steps_per_sample, expected.step_count));
  }
  return columns;
}

}  // namespace talus::dem
