// A small run with render points, for tests of what is drawn: a block of sand on a floor, in three frames.
#pragma once

#include <fstream>
#include <string>

#include "tests/program.h"

namespace talus::testing {

inline constexpr double block_lower = 0.03, block_upper = 0.07;  // m, along x and y
inline constexpr double block_height = 0.04, domain_size = 0.1;  // m

inline const std::string block_scene = R"(# A block of sand that falls apart.
schema = 1
[domain]
origin_m = [0.0, 0.0, 0.0]
size_m = [0.1, 0.1, 0.05]
cell_size_m = 0.01
gravity_m_s2 = [0.0, 0.0, -9.81]
z_lower = { kind = "wall", rough = true }
[[material]]
name = "sand"
grain_density_kg_m3 = 2500.0
max_volume_fraction = 0.6
friction_angle_deg = 30.0
[[sand]]
material = "sand"
shape = { kind = "box", lower_m = [0.03, 0.03, 0.0], upper_m = [0.07, 0.07, 0.04] }
[particles]
per_cell_axis = 2
jitter = 0.5
seed = 3
[time]
end_s = 0.05
frame_interval_s = 0.02
)";
inline const std::string with_points = block_scene + "[render_points]\nper_particle = 30\n";

/// Runs a scene to folder / "out"; the test fails where the program does.
inline std::filesystem::path run_scene(const std::filesystem::path& folder, const std::string& scene,
                                       const std::vector<std::string>& options = {}) {
  std::ofstream(folder / "scene.toml") << scene;
  std::vector<std::string> command{"talus", "run", (folder / "scene.toml").string(), "--output",
                                   (folder / "out").string()};
  command.insert(command.end(), options.begin(), options.end());
  const ProgramResult result = run_program(command);
  EXPECT_EQ(result.exit_code, 0) << result.output;
  return folder / "out";
}

}  // namespace talus::testing
