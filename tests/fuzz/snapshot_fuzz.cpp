// Snapshot files, by way of HDF5, whose own code is not instrumented.
#include "analysis/snapshot.h"
#include "tests/fuzz/fuzz_file.h"

// HDF5 1.10 loses some memory of its own with many damaged files; once per file, and not ours to mend.
extern "C" const char* __lsan_default_suppressions() { return "leak:libhdf5\n"; }

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = talus::testing::fuzz_file("snapshots.h5", data, size);
  talus::testing::may_refuse<talus::analysis::SnapshotError>([&] { talus::analysis::read_snapshots(file); });
  return 0;
}
