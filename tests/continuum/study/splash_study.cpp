// How round the splash is with cells of other sizes, and in a narrower bed so that small ones can be paid for. Run by hand:
//
//   splash_study consistent|paper WIDTH_MM CELL_MM ARRANGEMENTS
//
// splash.toml is 200 mm wide, with cells of 4 mm. With 120 mm, 2 mm and one arrangement: 1.1 million particles, four minutes.
#include <fmt/format.h>

#include <cstdlib>
#include <string_view>
#include <thread>

#include "continuum/parallel.h"
#include "tests/continuum/splash.h"

namespace {

using namespace talus;

/// The scene with a bed of another width around the same axis, and other cells.
Scene cut_to(Scene scene, double width, double cell) {
  const double lower = 0.1 - 0.5 * width, height = scene.grid.upper()[2], depth = 0.0806;
  scene.grid.origin = {lower, lower, 0.0};
  scene.grid.spacing = cell;
  scene.grid.cells = (Eigen::Vector3d(width, width, height) / cell).array().round().cast<int>();
  const Eigen::Vector3d size(width, width, depth);
  scene.fillings[0].shape = Shape{Box{scene.grid.origin + 0.5 * size, 0.5 * size}};
  return scene;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view scheme = argc == 5 ? argv[1] : "";
  const double width = argc == 5 ? 1e-3 * std::atof(argv[2]) : 0.0,
               cell = argc == 5 ? 1e-3 * std::atof(argv[3]) : 0.0;
  const int arrangements = argc == 5 ? std::atoi(argv[4]) : 0;
  if ((scheme != "consistent" && scheme != "paper") || !(width > 0.0) || !(cell > 0.0) || arrangements < 1) {
    fmt::print(stderr, "usage: splash_study consistent|paper WIDTH_MM CELL_MM ARRANGEMENTS\n");
    return 2;
  }
  set_thread_count(static_cast<int>(std::thread::hardware_concurrency()));
  Scene scene = read_scene(TALUS_SOURCE_DIR "/continuum/scenes/seed/splash.toml");
  scene.settings.scheme = scheme == "paper" ? Scheme::paper : Scheme::consistent;
  scene.render_points_per_particle = 0;
  const auto found = testing::splashes(cut_to(scene, width, cell), arrangements);
  for (std::size_t moment = 0; moment < found.size(); ++moment) {
    fmt::print("{:.2f} s: anisotropy {:.3f} (by chance {:.3f}, {} particles)\n",
               testing::splash_moments[moment], found[moment].anisotropy(), found[moment].by_chance(),
               found[moment].particles);
  }
  return 0;
}
