#include "dem_cases/reference/store.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <mutex>

#include "continuum/files/atomic_file.h"
#include "continuum/files/data_folder.h"
#include "continuum/files/input_error.h"

namespace talus::dem {
namespace {

using nlohmann::json;

constexpr const char* format_name = "talus-reference";
constexpr int format_version = 1;

auto name_of(const json& record) {
  return std::pair(record.at("code").get<std::string>(), record.at("seed").get<std::uint64_t>());
}

/// A record to a line: small, and a run more is a line more to git.
std::string text_of(const std::string& case_name, const std::string& point_name,
                    const std::vector<json>& records) {
  std::vector<std::string> lines;
  for (const json& record : records) lines.push_back(record.dump());
  const json heading{
      {"format", format_name}, {"version", format_version}, {"case", case_name}, {"point", point_name}};
  std::string text = heading.dump();
  text.pop_back();  // the brace that closes it
  return fmt::format("{},\"runs\":[\n{}\n]}}\n", text, fmt::join(lines, ",\n"));
}

}  // namespace

std::filesystem::path reference_folder() { return data_folder("dem_cases/reference/ensemble"); }

std::filesystem::path record_file(const std::filesystem::path& reference, const std::string& case_name,
                                  const std::string& point_name) {
  return reference / case_name / (point_name + ".json");
}

std::vector<json> read_records(const std::filesystem::path& reference, const std::string& case_name,
                               const std::string& point_name) {
  const auto file = record_file(reference, case_name, point_name);
  if (!std::filesystem::exists(file)) return {};
  try {
    const json all = json::parse(read_file(file));
    if (all.at("format") != format_name || all.at("version") != format_version) {
      throw InputError(fmt::format("{}: is not a {} of version {}; move it away and make the runs again",
                                   file.string(), format_name, format_version));
    }
    auto records = all.at("runs").get<std::vector<json>>();
    std::sort(records.begin(), records.end(),
              [](const json& a, const json& b) { return name_of(a) < name_of(b); });
    return records;
  } catch (const json::exception& error) {
    throw InputError(
        fmt::format("{}: damaged: {}; take it from git again, or move it away and make the runs again",
                    file.string(), error.what()));
  }
}

std::optional<json> find_record(const std::filesystem::path& reference, const PlannedRun& run,
                                const std::string& input_hash) {
  for (const json& record : read_records(reference, run.case_name, run.point_name)) {
    if (name_of(record) == std::pair(run.code, run.seed) && record.at("input_hash") == input_hash &&
        record.at("version") == run.version) {
      return record;
    }
  }
  return std::nullopt;
}

void store_record(const std::filesystem::path& reference, const json& record) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  const std::string case_name = record.at("case"), point_name = record.at("point");
  auto records = read_records(reference, case_name, point_name);
  std::erase_if(records, [&](const json& old) { return name_of(old) == name_of(record); });
  records.push_back(record);
  std::sort(records.begin(), records.end(),
            [](const json& a, const json& b) { return name_of(a) < name_of(b); });
  const auto file = record_file(reference, case_name, point_name);
  make_writable_folder(file.parent_path());
  write_file_atomically(file, text_of(case_name, point_name, records));
}

}  // namespace talus::dem
