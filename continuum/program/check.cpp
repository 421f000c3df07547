#include "continuum/program/check.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "continuum/files/input_error.h"
#include "continuum/files/memory.h"
#include "continuum/program/frames.h"
#include "continuum/scene/warnings.h"

namespace talus {
namespace {

void tell_cost(const Scene& scene, const SceneCost& cost) {
  const std::string steps = cost.most_steps > 1.05 * cost.fewest_steps
                                ? fmt::format("{:.3g} to {:.3g}", cost.fewest_steps, cost.most_steps)
                                : fmt::format("{:.3g}", cost.fewest_steps);
  fmt::print(
      "{}: {} x {} x {} cells, {:.3g} particles, {:.3g} render points, {} frames, about {} steps; about {} "
      "of memory, {} are free\n",
      scene.file.string(), scene.grid.cells[0], scene.grid.cells[1], scene.grid.cells[2], cost.particles,
      cost.render_points, frame_count(scene), steps, memory_text(cost.bytes),
      memory_text(memory_available()));
}

/// Whether the scene is fit to run.
bool fit(const std::filesystem::path& file, bool strict) {
  try {
    const Scene scene = read_scene(file);
    const SceneCost cost = scene_cost(scene);
    const auto warnings = scene_warnings(scene, cost, memory_available());
    for (const std::string& warning : warnings) fmt::print("warning: {}\n", warning);
    initial_state(scene);  // refuses sand that overlaps, or has no room
    if (!scene.broken.empty()) fmt::print("warning: {}\n", broken_text(scene));
    tell_cost(scene, cost);
    return !strict || (warnings.empty() && scene.broken.empty());
  } catch (const InputError& error) {
    fmt::print("error: {}\n", error.what());
    return false;
  }
}

}  // namespace

void check(const CheckOptions& options) {
  std::size_t unfit = 0;
  for (const auto& file : options.scenes) unfit += fit(file, options.strict) ? 0 : 1;
  if (unfit > 0)
    throw InputError(fmt::format("{} of {} scenes are not fit to run", unfit, options.scenes.size()));
}

void warn_of_dangers(const Scene& scene) {
  for (const std::string& warning : scene_warnings(scene, scene_cost(scene), memory_available()))
    spdlog::warn(warning);
}

}  // namespace talus
