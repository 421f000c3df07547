#include "continuum/render/run_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "continuum/files/atomic_file.h"
#include "continuum/files/input_error.h"
#include "continuum/files/provenance.h"

namespace talus {
namespace {

/// The scene that a run was made of.
std::filesystem::path scene_file_of(const std::filesystem::path& folder) {
  const auto summary = folder / "run.json";
  try {
    const auto run = nlohmann::json::parse(read_file(summary));
    std::filesystem::path file = run.at("scene_file").get<std::string>();
    const std::string hash = run.at("provenance").at("input_hash");
    if (std::filesystem::is_regular_file(file) && sha256(read_file(file)) == hash) return file;
  } catch (const nlohmann::json::exception& error) {
    throw InputError(
        fmt::format("{}: not a summary that this talus run writes: {}", summary.string(), error.what()));
  }
  return folder / "run.toml";
}

[[noreturn]] void refuse_frames(std::string_view text, std::string_view why) {
  throw InputError(
      fmt::format("--frames {}: {}; allowed are all, and lists like 0,5,10-20,30-last:3", text, why));
}

/// Takes a frame's number, or the word last, from the front of `rest`.
std::size_t take_number(std::string_view text, std::size_t last, std::string_view& rest) {
  constexpr std::string_view word = "last";
  if (rest.starts_with(word)) {
    rest.remove_prefix(word.size());
    return last;
  }
  std::size_t value = 0;
  const auto [end, failure] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
  if (failure != std::errc()) refuse_frames(text, "a frame's number was expected");
  rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  return value;
}

bool take(char sign, std::string_view& rest) {
  if (!rest.starts_with(sign)) return false;
  rest.remove_prefix(1);
  return true;
}

}  // namespace

RunFolder open_run(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder))
    throw InputError(fmt::format("{}: no such folder; it takes the OUTPUT of a talus run", folder.string()));
  RenderReader points(folder / "render.h5");
  if (points.frame_count() == 0)
    throw InputError(fmt::format("{}: holds no frame", (folder / "render.h5").string()));
  return {folder, read_scene(scene_file_of(folder)), std::move(points), read_bodies(folder)};
}

RenderFrame read_frame(const RunFolder& run, std::size_t index) {
  RenderFrame frame = run.points.read(index);
  const auto unknown = [&](std::uint8_t material) { return material >= run.scene.materials.size(); };
  if (std::any_of(frame.materials.begin(), frame.materials.end(), unknown) || !frame.positions.allFinite())
    throw InputError(fmt::format("{}: frame {} is not of the scene {}", (run.path / "render.h5").string(),
                                 index, run.scene.file.string()));
  return frame;
}

std::vector<std::size_t> chosen_frames(std::string_view text, std::size_t frame_count) {
  std::set<std::size_t> chosen;
  const auto choose = [&](std::size_t first, std::size_t last, std::size_t step) {
    if (last >= frame_count) refuse_frames(text, fmt::format("the run has frames 0 to {}", frame_count - 1));
    if (last < first || step == 0) refuse_frames(text, "a range goes upwards, by at least 1");
    for (std::size_t frame = first; frame <= last; frame += step) chosen.insert(frame);
  };
  const std::size_t last_frame = frame_count - 1;
  std::string_view rest = text;
  if (text == "all") {
    choose(0, last_frame, 1);
    rest = {};
  } else {
    do {
      const std::size_t first = take_number(text, last_frame, rest);
      const std::size_t last = take('-', rest) ? take_number(text, last_frame, rest) : first;
      choose(first, last, take(':', rest) ? take_number(text, last_frame, rest) : 1);
    } while (take(',', rest));
  }
  if (!rest.empty()) refuse_frames(text, fmt::format("'{}' is not understood", rest));
  return {chosen.begin(), chosen.end()};
}

double point_spacing(const RunFolder& run) { return std::cbrt(1.0 / run.points.points_per_volume()); }

}  // namespace talus
