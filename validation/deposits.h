// Pictures for the report, from the snapshots of a suite's runs.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace talus::validation {

/// One entry of picture_of_series (pictures.h) for the first seed of each code of each point whose snapshots are there: in the suite's own
/// folder, or, for runs from the committed ensemble, in `reference_runs`, where talus-dem keeps them; there only if the record beside them is
/// the very one. Reading snapshots takes long, so each picture is kept in `output`/pictures and taken from there the next time, which needs no
/// snapshots; kept pictures of other runs are removed. Throws SnapshotError for damaged snapshots.
nlohmann::json pictures_of(const nlohmann::json& results, const std::filesystem::path& output,
                           const std::filesystem::path& reference_runs);

}  // namespace talus::validation
