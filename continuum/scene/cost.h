// What a scene is going to need, before it runs.
#pragma once

#include "continuum/scene/scene.h"

namespace talus {

struct SceneCost {
  double lattice_points;  // that are looked at to fill the shapes
  double
      particles;  // at most: of the shapes whole, and of what sources can send or the domain hold; none split or merged
  double render_points;
  double fewest_steps, most_steps;  // as if all moved slowly, and as if the fastest moved so all the time
  double bytes;                     // of memory, at the peak of a run: see cost.cpp for how that was measured
};

/// Estimates, from a scene that need not have been checked for walls and bodies yet.
SceneCost scene_cost(const Scene& scene);

}  // namespace talus
