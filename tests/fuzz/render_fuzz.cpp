// Files of render points, by way of HDF5, whose own code is not instrumented.
#include "continuum/files/input_error.h"
#include "continuum/render/render_file.h"
#include "tests/fuzz/fuzz_file.h"

// HDF5 1.10 loses some memory of its own with many damaged files; once per file, and not ours to mend.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5\n"; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = talus::testing::fuzz_file("render.h5", data, size);
  talus::testing::may_refuse<talus::InputError>([&] {
    const talus::RenderReader reader(file);
    for (std::size_t frame = 0; frame < reader.frame_count(); ++frame) reader.read(frame);
  });
  return 0;
}
