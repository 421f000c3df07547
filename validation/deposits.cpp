#include "validation/deposits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/body_track.h"
#include "analysis/snapshot.h"
#include "continuum/files/atomic_file.h"
#include "continuum/files/provenance.h"
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

/// Counts the changes to what picture_of_series draws: pictures kept from before are not used then.
constexpr int picture_version = 1;

/// Where the picture of a run is kept; all that it depends on decides the name.
std::filesystem::path kept_picture(const std::filesystem::path& folder, const json& point, const json& run) {
  const json decisive{{"picture_version", picture_version},
                      {"parameters", point.at("parameters")},
                      {"calibration", point.at("calibration")},
                      {"run", run}};
  return folder / (sha256(decisive.dump()) + ".json");
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

json draw(const json& point, const json& run, const std::filesystem::path& snapshots) {
  json picture = picture_of_series(analysis::read_snapshots(snapshots), options_for(point, run));
  if (json sphere = sphere_at_moments(point, picture, snapshots.parent_path()); !sphere.is_null())
    picture["sphere"] = std::move(sphere);
  return picture;
}

/// Null if it is neither kept nor can be drawn.
json kept_or_drawn(const json& point, const json& run, const std::filesystem::path& kept,
                   const std::filesystem::path& output, const std::filesystem::path& reference_runs) {
  if (std::filesystem::exists(kept)) {
    json picture = json::parse(read_file(kept), nullptr, false);
    if (picture.is_object()) return picture;
  }
  auto snapshots = snapshots_below(output / "runs", point, run);
  if (!snapshots && run.at("origin") == "ensemble") snapshots = snapshots_below(reference_runs, point, run);
  if (!snapshots) return nullptr;
  json picture = draw(point, run, *snapshots);
  write_file_atomically(kept, picture.dump());
  return picture;
}

void remove_others(const std::filesystem::path& folder, const std::set<std::filesystem::path>& used) {
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!used.contains(entry.path())) std::filesystem::remove(entry.path());
  }
}

}  // namespace

json pictures_of(const json& results, const std::filesystem::path& output,
                 const std::filesystem::path& reference_runs) {
  const auto folder = output / "pictures";
  make_writable_folder(folder);
  json pictures = json::array();
  std::set<std::filesystem::path> used;
  for (const auto& point : results.at("points")) {
    std::set<std::string> drawn;
    for (const auto& run : point.at("runs")) {
      const std::string code = run.at("code");
      if (code == coarse_code || code == short_steps_code || drawn.contains(code)) continue;
      const auto kept = kept_picture(folder, point, run);
      json picture = kept_or_drawn(point, run, kept, output, reference_runs);
      if (picture.is_null()) continue;
      pictures.push_back(std::move(picture));
      used.insert(kept);
      drawn.insert(code);
    }
  }
  remove_others(folder, used);
  return pictures;
}

}  // namespace talus::validation
