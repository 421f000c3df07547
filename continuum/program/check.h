// `talus check`: what is wrong or dangerous with scenes, without running them; and the warnings at the start of a run.
#pragma once

#include <filesystem>
#include <vector>

#include "continuum/scene/scene.h"

namespace talus {

struct CheckOptions {
  std::vector<std::filesystem::path> scenes;
  bool strict = false;  // warnings count as errors
};

/// Tells of each scene its errors and warnings, and what it is going to need; reads them all, whatever is wrong with the first.
/// Throws InputError with the number of scenes that are not fit to run.
void check(const CheckOptions& options);

/// The warnings of a scene, in the log.
void warn_of_dangers(const Scene& scene);

}  // namespace talus
