#include "validation/deposits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/body_track.h"
#include "analysis/snapshot.h"
#include "continuum/files/atomic_file.h"
#include "validation/backends/continuum.h"
#include "validation/pictures.h"

namespace talus::validation {
namespace {

using nlohmann::json;

/// Below `runs`, if it holds this very run.
std::optional<std::filesystem::path> snapshots_below(const std::filesystem::path& runs, const json& point,
                                                     const json& run) {
  const auto folder =
      runs / point.at("case").get<std::string>() / point.at("point").get<std::string>() /
      fmt::format("{}_seed{}", run.at("code").get<std::string>(), run.at("seed").get<std::uint64_t>());
  if (!std::filesystem::exists(folder / "record.json") || !std::filesystem::exists(folder / "snapshots.h5"))
    return std::nullopt;
  const json record = json::parse(read_file(folder / "record.json"), nullptr, false);
  if (!record.is_object() || record.value("input_hash", "") != run.at("input_hash")) return std::nullopt;
  return folder / "snapshots.h5";
}

PictureOptions options_for(const json& point, const json& run) {
  PictureOptions options;
  options.name = point.at("name");
  options.code = run.at("code");
  options.seed = run.at("seed");
  const auto& parameters = point.at("parameters");
  const double d = parameters.at("grains").at("diameter_m");
  const bool quasi_2d = parameters.at("geometry").contains("thickness_m");
  if (quasi_2d)
    options.thickness = run.at("thickness_m");
  else
    options.slice_half_width = d;
  if (options.code == continuum_code)
    options.packing = point.at("calibration").at("max_volume_fraction").get<double>();
  options.field_spacing = 2.0 * d;
  return options;
}

/// Where a falling sphere is at the picture's moments, from the track beside the snapshots: [{x, z, radius}], m. Nothing for other cases.
json sphere_at_moments(const json& point, const json& picture, const std::filesystem::path& folder) {
  const auto& geometry = point.at("parameters").at("geometry");
  if (!geometry.contains("sphere_diameter_m")) return nullptr;
  const auto track = analysis::read_body_track(folder / analysis::body_track_file);
  json places = json::array();
  for (const auto& moment : picture.at("moments")) {
    const auto from = [&](const analysis::BodyMoment& row) {
      return std::abs(row.time - moment.at("time").get<double>());
    };
    const auto& row = *std::ranges::min_element(track, {}, from);
    places.push_back({{"x", row.position.x()},
                      {"z", row.position.z()},
                      {"radius", 0.5 * geometry.at("sphere_diameter_m").get<double>()}});
  }
  return places;
}

}  // namespace

json pictures_of(const json& results, const std::filesystem::path& output,
                 const std::filesystem::path& reference_runs) {
  json pictures = json::array();
  for (const auto& point : results.at("points")) {
    std::set<std::string> drawn;
    for (const auto& run : point.at("runs")) {
      const std::string code = run.at("code");
      if (code == coarse_code || code == short_steps_code || drawn.contains(code)) continue;
      auto file = snapshots_below(output / "runs", point, run);
      if (!file && run.at("origin") == "ensemble") file = snapshots_below(reference_runs, point, run);
      if (!file) continue;
      json picture = picture_of_series(analysis::read_snapshots(*file), options_for(point, run));
      if (json sphere = sphere_at_moments(point, picture, file->parent_path()); !sphere.is_null())
        picture["sphere"] = std::move(sphere);
      pictures.push_back(std::move(picture));
      drawn.insert(code);
    }
  }
  return pictures;
}

}  // namespace talus::validation
