// The time of a scene, cut into frames, and the steps that lead to the end of each: what `talus run` and `talus bench` do alike.
#pragma once

#include <algorithm>
#include <cmath>

#include "continuum/scene/scene.h"

namespace talus {

/// Frames until the scene's end; the last one may be shorter.
inline int frame_count(const Scene& scene) {
  return static_cast<int>(std::ceil(scene.end_time / scene.frame_interval - 1e-9));
}

/// Calls take_step(dt_limit), which advances `state` by at most so many seconds, until `frame` (from 1) ends.
template <class TakeStep>
void run_to_frame(const Scene& scene, int frame, State& state, const TakeStep& take_step) {
  const double frame_end = std::min(frame * scene.frame_interval, scene.end_time);
  while (frame_end - state.time > 1e-9 * scene.frame_interval) take_step(frame_end - state.time);
  // A step that ended at an event just behind the frame's end stays there: going back would meet the event again.
  state.time = std::max(state.time, frame_end);
}

}  // namespace talus
