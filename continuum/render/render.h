// `talus render`: pictures of a run, and a film of them, by POV-Ray and ffmpeg, which are called as programs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "continuum/render/camera.h"

namespace talus {

struct RenderOptions {
  std::filesystem::path run;
  std::optional<std::filesystem::path> output;  // else RUN/pictures
  std::string frames = "all";                   // as chosen_frames has it
  int width = 960, height = 540;                // pixels
  int samples = 2;                              // along each axis of a pixel, where neighbours differ
  CameraWish camera;
  std::optional<Eigen::Vector3d> sun;  // towards it
  double sun_width = 4.0;              // degrees
  std::vector<std::string> colours;    // "MATERIAL=#RRGGBB"
  double point_size = 1.0;             // to the default radius
  std::optional<std::string> film;     // its name, ending in .mp4 or .webm
  double pictures_per_second = 24.0;   // of the film
  bool keep_scenes = false;            // what POV-Ray read
  int threads = 1;
};

/// Writes OUTPUT/frame_000000.png and so on, and the film. Throws InputError; std::runtime_error when a program fails.
void render(const RenderOptions& options);

}  // namespace talus
