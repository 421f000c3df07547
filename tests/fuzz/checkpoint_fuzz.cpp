// Checkpoints whose SHA-256 is right, whatever they say: read, and put in the place of what their scene starts with.
#include "continuum/files/input_error.h"
#include "continuum/files/provenance.h"
#include "continuum/io/checkpoint.h"
#include "continuum/io/state_archive.h"
#include "continuum/scene/scene.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace talus;
  static const State start = initial_state(read_scene(TALUS_SOURCE_DIR "/tests/fuzz/checkpoint_scene.toml"));
  const std::string content(reinterpret_cast<const char*>(data), size);
  const std::string whole = "talus-checkpoint 1 sha256 " + sha256(content) + "\n" + content;
  const auto file =
      testing::fuzz_file(checkpoint_name, reinterpret_cast<const std::uint8_t*>(whole.data()), whole.size());
  testing::may_refuse<InputError>([&] {
    std::string told;
    const Checkpoint checkpoint = read_checkpoint(file.parent_path(), told);
    State state = start;
    restore(checkpoint.state, "checkpoint", state);
    const Budget budget(checkpoint.budget, "checkpoint", state);
    BodyLog().restore(checkpoint.body_log, "checkpoint");
  });
  return 0;
}
