// Made-up results for tests of the report: plausible in shape and size, measured by nobody.
#pragma once

#include <nlohmann/json.hpp>

namespace talus::testing {

/// A results.json of schema version 1: one case, three backends, two seeds, every part present.
nlohmann::json sample_results();

/// The deposits that belong to it.
nlohmann::json sample_pictures();

}  // namespace talus::testing
