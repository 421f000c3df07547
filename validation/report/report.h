// The page that people read: results.json and the pictures of one suite as one HTML file.
//
// The file holds everything it needs (style, script, Chart.js, the data) and forbids itself the network, so
// it can be mailed, archived and printed, and shows the same in ten years. The page is drawn in the browser
// from the embedded data; what it shows is therefore exactly what results.json says. A point is drawn when its section is
// opened; all of them are before printing, or when the address ends in #all. Whatever is drawn is told on <body> in data-charts
// (figures drawn) and data-errors (errors caught), for tests to read.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace talus {

/// Writes the report whole or not at all.
/// `results`: the content of results.json, schema version 2. Absent or null parts are shown as absent.
/// `pictures`: what is too bulky for results.json: an array of picture_of_series() (validation/pictures.h). Of each point
///   and code the lowest seed is shown.
/// Throws InputError when the file cannot be written.
void write_report(const nlohmann::json& results, const nlohmann::json& pictures,
                  const std::filesystem::path& file);

}  // namespace talus
