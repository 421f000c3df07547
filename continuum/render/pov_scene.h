// A frame as POV-Ray reads it: every render point a sphere, one texture for each shade of a material; a sun that casts soft
// shadows and two lights that fill them; the floor, the walls that stand, glass where they are hollow, and the bodies.
#pragma once

#include <cstdio>
#include <filesystem>
#include <vector>

#include "continuum/render/camera.h"
#include "continuum/render/colours.h"
#include "continuum/render/run_folder.h"

namespace talus {

/// What stays the same from frame to frame.
struct Look {
  Camera camera;
  double aspect;                // width / height of the picture
  Eigen::Vector3d sun;          // unit vector towards it
  double sun_width;             // degrees that it is wide: what softens shadows
  std::vector<Colour> colours;  // of the materials
  double radius;                // m, mean, of the points
};

/// Where the sun stands unless a user says so: to the left of the viewer, 43 degrees high. A unit vector.
Eigen::Vector3d default_sun(const Scene& scene);

/// Writes the scene of a frame. Throws InputError when the file cannot be written to, or a body has no place yet.
void write_pov_scene(const std::filesystem::path& file, const RunFolder& run, const RenderFrame& frame,
                     const Look& look);

}  // namespace talus
