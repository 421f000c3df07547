// The page that people read: results.json and the pictures of one suite as one HTML file.
//
// The file holds everything it needs (style, script, Chart.js, the data) and forbids itself the network, so
// it can be mailed, archived and printed, and shows the same in ten years. The page is drawn in the browser
// from the embedded data; what it shows is therefore exactly what results.json says. Once drawn, it sets on
// <body> data-charts (figures drawn) and data-errors (errors caught), for tests to read.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace talus {

/// Writes the report whole or not at all.
/// `results`: the content of results.json, schema version 1. Absent or null parts are shown as absent.
/// `pictures`: deposits to draw, too bulky for results.json: an array of
///   {case, backend, seed, time (s), x, z, radius, x0 (m; arrays of one length)}, x0 being where the item
///   started.
/// Throws InputError when the file cannot be written.
void write_report(const nlohmann::json& results, const nlohmann::json& pictures,
                  const std::filesystem::path& file);

}  // namespace talus
