// The reference ensemble: what the discrete codes' runs gave, one JSON file for each parameter point of a case, small enough to
// be committed.
//
//   REFERENCE/CASE/POINT.json   {"format": "talus-reference", "version": 1, "case", "point", "runs": [record, ...]}
//
// A record is what make_run() returns. A run has one record: its code and seed are its name, its input hash and the code's
// version say whether it is still the run that is wanted.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "dem_cases/planned_run.h"

namespace talus::dem {

/// The committed ensemble, of the cases that come with Talus.
std::filesystem::path reference_folder();

/// Where the records of a case's point stand.
std::filesystem::path record_file(const std::filesystem::path& reference, const std::string& case_name,
                                  const std::string& point_name);

/// All records of a point, in the order of code and seed; none when there is no file. Throws InputError when it is
/// not one of ours.
std::vector<nlohmann::json> read_records(const std::filesystem::path& reference, const std::string& case_name,
                                         const std::string& point_name);

/// The stored record of this very run: same code and version, seed and inputs.
std::optional<nlohmann::json> find_record(const std::filesystem::path& reference, const PlannedRun& run,
                                          const std::string& input_hash);

/// Adds a record, in place of an older one of the same code and seed; the file is at all times whole. Safe from
/// several threads of one program. Throws InputError when it cannot be written.
void store_record(const std::filesystem::path& reference, const nlohmann::json& record);

}  // namespace talus::dem
