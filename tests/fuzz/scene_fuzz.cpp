// Scenes, and what is warned of in those that pass; of sizes that take no time. A mesh lies beside them.
#include "continuum/files/checked_table.h"
#include "continuum/files/memory.h"
#include "continuum/scene/warnings.h"
#include "tests/continuum/solids/mesh_files.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  using namespace talus::testing;
  write_text_stl(fuzz_folder() / "cube.stl", box_mesh({0, 0, 0}, {1, 1, 1}));
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = talus::testing::fuzz_file("scene.toml", data, size);
  const talus::SceneLimits small{.cells = 2000, .particles = 1e6, .render_points = 1e6};
  talus::testing::may_refuse<talus::InputError>([&] {
    const talus::Scene scene = talus::read_scene(file, small);
    talus::scene_warnings(scene, talus::scene_cost(scene), talus::memory_available());
  });
  return 0;
}
