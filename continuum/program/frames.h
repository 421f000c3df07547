// What `talus run` and `talus bench` do alike: the time of a scene, cut into frames, the steps that lead to the end of each, and
// a word on solvers that are broken on purpose.
#pragma once

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "continuum/scene/scene.h"

namespace talus {

/// What to say of a scene with a `broken` solver.
inline std::string broken_text(const Scene& scene) {
  return fmt::format(
      "{}: [solver] broken = \"{}\" makes this solver wrong on purpose, for the harness's mutation check; "
      "its results are not sand's",
      scene.file.string(), scene.broken);
}

/// So that nobody uses one unknowingly.
inline void warn_if_broken(const Scene& scene) {
  if (!scene.broken.empty()) spdlog::warn(broken_text(scene));
}

/// Frames until the scene's end; the last one may be shorter.
inline int frame_count(const Scene& scene) {
  return static_cast<int>(std::ceil(scene.end_time / scene.frame_interval - 1e-9));
}

/// Calls take_step(dt_limit), which advances `state` by at most so many seconds, until `frame` (from 1) ends, or until it returns
/// false: then run_to_frame does.
template <class TakeStep>
bool run_to_frame(const Scene& scene, int frame, State& state, const TakeStep& take_step) {
  const double frame_end = std::min(frame * scene.frame_interval, scene.end_time);
  while (frame_end - state.time > 1e-9 * scene.frame_interval) {
    if (!take_step(frame_end - state.time)) return false;
  }
  // A step that ended at an event just behind the frame's end stays there: going back would meet the event again.
  state.time = std::max(state.time, frame_end);
  return true;
}

}  // namespace talus
