#include "validation/suites/suite.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "continuum/files/atomic_file.h"
#include "continuum/files/checked_table.h"
#include "continuum/files/data_folder.h"
#include "continuum/files/faults.h"
#include "continuum/files/provenance.h"
#include "validation/mutants.h"

namespace talus::validation {
namespace {

constexpr std::array<std::string_view, 3> code_names{"continuum", "liggghts", "yade"};

std::filesystem::path suite_file(const std::string& name_or_file) {
  if (name_or_file.ends_with(".toml")) return name_or_file;
  const auto names = suite_names();
  if (std::find(names.begin(), names.end(), name_or_file) == names.end()) {
    const auto meant = nearest_name(name_or_file, {names.begin(), names.end()});
    throw InputError(fmt::format("suite '{}' is not known{}; give one of: {}; or the path of a .toml file",
                                 name_or_file, meant ? fmt::format(" (did you mean '{}'?)", *meant) : "",
                                 fmt::join(names, ", ")));
  }
  return data_folder("validation/suites") / (name_or_file + ".toml");
}

void require_file(const CheckedTable& table, std::string_view key, const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file))
    throw table.error(key, fmt::format("{}: no such file", file.string()));
}

/// What all points of a suite share.
struct Common {
  std::filesystem::path folder, calibration;
  int particles_per_cell_axis;
  double lattice_jitter;
  std::vector<std::uint64_t> seeds;
  bool refinement;
};

std::vector<std::uint64_t> read_seeds(const CheckedTable& table, const std::string& key) {
  const auto seeds = table.integers(key, 0, std::numeric_limits<std::int64_t>::max(), true);
  return {seeds.begin(), seeds.end()};
}

std::vector<std::string> read_codes(const CheckedTable& table) {
  if (!table.has("codes")) return {code_names.begin(), code_names.end()};
  auto codes = table.strings("codes");
  for (const auto& code : codes) {
    if (std::find(code_names.begin(), code_names.end(), code) == code_names.end())
      throw table.error("codes", fmt::format("must hold only: {}", fmt::join(code_names, ", ")));
    if (std::count(codes.begin(), codes.end(), code) > 1)
      throw table.error("codes", "must not repeat an entry");
  }
  return codes;
}

/// The points of one [[case]], each a whole case.
std::vector<dem::Case> read_case(const CheckedTable& table, const std::filesystem::path& folder) {
  const auto file = (folder / table.string("file")).lexically_normal();
  require_file(table, "file", file);
  auto all = dem::read_case_points(file);
  if (!table.has("points")) return all;
  std::vector<dem::Case> wanted;
  for (const auto& name : table.strings("points")) {
    const auto found = std::ranges::find_if(all, [&](const dem::Case& point) { return point.point == name; });
    if (found == all.end()) {
      std::vector<std::string> names;
      for (const auto& point : all) names.push_back(point.point);
      throw table.error(
          "points", fmt::format("names no point of {}; it has: {}", file.string(), fmt::join(names, ", ")));
    }
    wanted.push_back(*found);
  }
  return wanted;
}

std::vector<SuitePoint> read_suite_case(const CheckedTable& table, const Common& common) {
  SuitePoint shared{.a_case = {},
                    .material = {},
                    .resolution = {static_cast<int>(table.integer("cells", 4, 1000)),
                                   common.particles_per_cell_axis, common.lattice_jitter},
                    .refinement = common.refinement,
                    .seeds = {},
                    .stored = table.boolean("stored", false),
                    .tags = {},
                    .required = {},
                    .time_limit = table.number("time_limit_s", {1e-3, 1e7})};
  if (common.refinement && shared.resolution.cells % 2 != 0)
    throw table.error("cells", "must be even: the refinement runs with half as many");
  if (table.has("tags")) {
    const auto tags = table.strings("tags");
    shared.tags = {tags.begin(), tags.end()};
  }
  if (table.has("requires")) shared.required = table.strings("requires");
  const auto codes = read_codes(table);
  std::map<std::string, std::vector<std::uint64_t>> own_seeds;
  for (const std::string code : {"liggghts", "yade"}) {
    if (table.has(code + "_seeds")) own_seeds[code] = read_seeds(table, code + "_seeds");
  }
  std::vector<SuitePoint> points;
  for (auto& a_case : read_case(table, common.folder)) {
    SuitePoint point = shared;
    for (const auto& code : codes) {
      if (code == "continuum")
        point.seeds[code] = common.seeds;
      else
        point.seeds[code] = own_seeds.contains(code) ? own_seeds.at(code) : a_case.reference_seeds[code];
    }
    point.material = dem::read_calibration(common.calibration, a_case.calibration);
    point.a_case = std::move(a_case);
    points.push_back(std::move(point));
  }
  table.finish();
  return points;
}

Common read_common(const CheckedTable& root, const std::filesystem::path& folder,
                   const std::filesystem::path& calibration) {
  const CheckedTable table = root.table("continuum");
  Common common{
      .folder = folder,
      .calibration = calibration,
      .particles_per_cell_axis = static_cast<int>(table.integer("particles_per_cell_axis", 2, 8)),
      .lattice_jitter = table.number("lattice_jitter", {0.0, 1.0}),
      .seeds = {},
      .refinement = table.boolean("refinement", false),
  };
  const auto seeds = table.integers("seeds", 0, std::numeric_limits<std::int64_t>::max());
  common.seeds = {seeds.begin(), seeds.end()};
  table.finish();
  return common;
}

std::vector<std::string> read_mutants(const CheckedTable& root) {
  if (!root.has("mutants")) return {};
  auto mutants = root.strings("mutants");
  for (const auto& name : mutants) {
    if (!find_mutant(name))
      throw root.error("mutants", fmt::format("must hold only: {}", fmt::join(mutant_names(), ", ")));
  }
  return mutants;
}

void read_points(const CheckedTable& root, const Common& common, Faults& faults, Suite& suite) {
  std::vector<CheckedTable> tables;
  passes(faults, [&] { tables = root.tables("case"); });
  for (const auto& table : tables)
    passes(faults,
           [&] { std::ranges::move(read_suite_case(table, common), std::back_inserter(suite.points)); });
}

/// Names tell results apart, and what is required must be there.
void check_points(const CheckedTable& root, const Suite& suite) {
  std::set<std::string> names;
  for (const auto& point : suite.points) {
    if (!names.insert(point.name()).second)
      throw root.error("case",
                       fmt::format("gives the point '{}' twice; names tell results apart", point.name()));
  }
  for (const auto& point : suite.points) {
    for (const auto& required : point.required) {
      if (!names.contains(required))
        throw root.error("case", fmt::format("'{}' requires '{}', which is no point of this suite",
                                             point.name(), required));
    }
  }
}

}  // namespace

std::vector<std::string> suite_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(data_folder("validation/suites"))) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem());
  }
  std::sort(names.begin(), names.end());
  return names;
}

Suite read_suite(const std::string& name_or_file) {
  const CheckedTable root = CheckedTable::parse_file(suite_file(name_or_file));
  root.require_schema(2);
  Suite suite;
  suite.file = root.file();
  const auto folder = suite.file.parent_path();
  Faults faults;
  passes(faults, [&] {
    suite.name = dem::read_folder_name(root, "name");
    suite.title = root.string("title");
    suite.input_hash = sha256(read_file(suite.file));
  });
  passes(faults, [&] { suite.mutants = read_mutants(root); });
  const bool calibrated = passes(faults, [&] {
    suite.calibration = (folder / root.string("calibration")).lexically_normal();
    require_file(root, "calibration", suite.calibration);
    suite.calibration_hash = sha256(read_file(suite.calibration));
  });
  Common common;
  if (passes(faults, [&] { common = read_common(root, folder, suite.calibration); }) && calibrated)
    read_points(root, common, faults, suite);
  if (faults.empty()) passes(faults, [&] { check_points(root, suite); });
  if (faults.empty()) root.finish();
  refuse(faults);
  return suite;
}

Suite tagged(Suite suite, const std::string& tag) {
  if (tag.empty()) return suite;
  suite.tag = tag;
  std::set<std::string> wanted, known;
  for (const auto& point : suite.points) {
    known.insert(point.tags.begin(), point.tags.end());
    if (!point.tags.contains(tag)) continue;
    wanted.insert(point.name());
    wanted.insert(point.required.begin(), point.required.end());
  }
  if (wanted.empty()) {
    throw InputError(fmt::format("{}: no case carries the tag '{}'; there are: {}", suite.file.string(), tag,
                                 fmt::join(known, ", ")));
  }
  std::erase_if(suite.points, [&](const SuitePoint& point) { return !wanted.contains(point.name()); });
  return suite;
}

}  // namespace talus::validation
