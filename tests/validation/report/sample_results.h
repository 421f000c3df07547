// Made-up results for tests of the report: plausible in shape and size, measured by nobody.
#pragma once

#include <nlohmann/json.hpp>

namespace talus::testing {

/// A results.json of schema version 2 with every part that there is: a column (with length unit, curves, profile, numerical runs), a slot
/// (mass curves, no profile) and a heap (profile alone); every verdict in both gates; metrics, fits, history, mutants.
nlohmann::json sample_results();

/// Pictures of the column for its three codes, packed as picture_of_series() packs them.
nlohmann::json sample_pictures();

/// The same results and pictures with this many columns, each under a name of its own.
nlohmann::json many_points(int count);
nlohmann::json many_pictures(int count);

}  // namespace talus::testing
