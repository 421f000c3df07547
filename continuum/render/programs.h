// The programs that draw: found on PATH, run to their end, their last words told when they fail.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace talus {

struct PictureSize {
  int width, height;  // pixels
};

/// Draws `scene`, a file in `folder`, to `picture` there, which is whole or not there. Throws std::runtime_error with what
/// POV-Ray said when it fails.
void draw_with_povray(const std::filesystem::path& povray, const std::filesystem::path& folder,
                      const std::string& scene, const std::string& picture, PictureSize size, int samples,
                      int threads);

/// Makes a film of pictures in `folder`, in that order: H.264 when its name ends in .mp4, VP9 when in .webm.
void film_with_ffmpeg(const std::filesystem::path& ffmpeg, const std::filesystem::path& folder,
                      const std::vector<std::string>& pictures, double pictures_per_second,
                      const std::string& film);

}  // namespace talus
