// STL and OBJ files. The first byte says which: OBJ where it is 'o', else STL; the rest is the file.
#include "continuum/files/checked_table.h"
#include "continuum/solids/mesh.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto file = talus::testing::fuzz_file(data[0] == 'o' ? "mesh.obj" : "mesh.stl", data + 1, size - 1);
  talus::testing::may_refuse<talus::InputError>([&] {
    const talus::Mesh mesh = talus::read_mesh(file);
    const Eigen::AlignedBox3d box = talus::bounds(mesh);
    if (!(talus::signed_distance(mesh, box.min()) > -1e300)) std::abort();  // NaN
  });
  return 0;
}
