#include "validation/suites/suite.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "continuum/files/provenance.h"
#include "validation/backends/backend.h"

namespace talus::validation {
namespace {

std::filesystem::path suite_file(const std::string& name_or_file) {
  if (name_or_file.ends_with(".toml")) return name_or_file;
  const auto names = suite_names();
  if (std::find(names.begin(), names.end(), name_or_file) == names.end()) {
    const auto meant = nearest_name(name_or_file, {names.begin(), names.end()});
    throw InputError(fmt::format("suite '{}' is not known{}; give one of: {}; or the path of a .toml file",
                                 name_or_file, meant ? fmt::format(" (did you mean '{}'?)", *meant) : "",
                                 fmt::join(names, ", ")));
  }
  return std::filesystem::path(TALUS_SUITE_FOLDER) / (name_or_file + ".toml");
}

SuiteCase read_suite_case(const CheckedTable& table, const std::filesystem::path& folder) {
  SuiteCase entry;
  entry.column = dem::read_case((folder / table.string("file")).lexically_normal());
  entry.backends = table.strings("backends");
  for (const auto& backend : entry.backends) {
    if (std::find(backend_names.begin(), backend_names.end(), backend) == backend_names.end()) {
      throw table.error("backends", fmt::format("must hold only: {}", fmt::join(backend_names, ", ")));
    }
    if (std::count(entry.backends.begin(), entry.backends.end(), backend) > 1) {
      throw table.error("backends", "must not repeat an entry");
    }
  }
  entry.seeds = entry.column.seeds;
  if (table.has("seeds")) {
    const auto seeds = table.integers("seeds", 0, std::numeric_limits<std::int64_t>::max());
    entry.seeds.assign(seeds.begin(), seeds.end());
  }
  entry.time_limit = table.number("time_limit_s", positive);
  const CheckedTable cost = table.table("expected_cpu_s");
  for (const auto& backend : entry.backends) entry.expected_cpu[backend] = cost.number(backend, positive);
  for (const auto backend : backend_names) cost.has(backend);  // known, even where this case does not use it
  cost.finish();
  table.finish();
  return entry;
}

}  // namespace

std::vector<std::string> suite_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(TALUS_SUITE_FOLDER)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem());
  }
  std::sort(names.begin(), names.end());
  return names;
}

Suite read_suite(const std::string& name_or_file) {
  const CheckedTable root = CheckedTable::parse_file(suite_file(name_or_file));
  root.require_schema(1);
  Suite suite;
  suite.file = root.file();
  const auto folder = suite.file.parent_path();
  suite.name = root.string("name");
  suite.title = root.string("title");
  suite.calibration = (folder / root.string("calibration")).lexically_normal();
  suite.input_hash = sha256(read_file(suite.file));
  suite.calibration_hash = sha256(read_file(suite.calibration));
  const CheckedTable resolution = root.table("continuum");
  suite.resolution.cells_per_column_length =
      static_cast<int>(resolution.integer("cells_per_column_length", 4, 1000));
  suite.resolution.particles_per_cell_axis =
      static_cast<int>(resolution.integer("particles_per_cell_axis", 2, 8));
  suite.resolution.lattice_jitter = resolution.number("lattice_jitter", {0.0, 1.0});
  resolution.finish();
  for (const auto& table : root.tables("case")) {
    suite.cases.push_back(read_suite_case(table, folder));
    auto& column = suite.cases.back().column;
    suite.cases.back().material = dem::read_calibration(suite.calibration, column.calibration);
    const auto& name = column.name;
    const auto same = [&](const SuiteCase& other) { return other.column.name == name; };
    if (std::count_if(suite.cases.begin(), suite.cases.end(), same) > 1) {
      throw table.error(
          "file", fmt::format("is the second case named '{}' of this suite; names tell results apart", name));
    }
  }
  root.finish();
  return suite;
}

}  // namespace talus::validation
