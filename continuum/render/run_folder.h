// The folder that `talus run` filled, as those who draw it see it: its scene, its render points, its bodies.
#pragma once

#include <string_view>

#include "continuum/render/bodies.h"
#include "continuum/render/render_file.h"
#include "continuum/scene/scene.h"

namespace talus {

struct RunFolder {
  std::filesystem::path path;
  Scene scene;
  RenderReader points;
  std::vector<DrawnBody> bodies;

  std::size_t frame_count() const { return points.frame_count(); }
};

/// Reads the scene from where it was, if it is still the same there (so that its meshes are found), else the run's own copy.
/// Throws InputError when the folder is not a finished run that wrote render points.
RunFolder open_run(const std::filesystem::path& folder);

/// Reads one frame. Throws InputError also where it does not go with the run's scene.
RenderFrame read_frame(const RunFolder& run, std::size_t frame);

/// Frames by number, in order: "all", or a list of N, FIRST-LAST and FIRST-LAST:STEP with commas between, where
/// "last" is a number too. Throws
/// InputError when the text is something else, or names a frame that the run does not have.
std::vector<std::size_t> chosen_frames(std::string_view text, std::size_t frame_count);

/// The points' mean distance from each other in sand at its packing limit, m.
double point_spacing(const RunFolder& run);

}  // namespace talus
