// What is drawn of the sand at one moment of a run.
#pragma once

#include "continuum/render/render_file.h"
#include "continuum/step.h"

namespace talus {

/// The render points of a state that has some, with the normals of the sand as it is now. Throws std::invalid_argument when
/// a material's index does not fit a byte.
RenderFrame render_frame_of(const State& state);

}  // namespace talus
