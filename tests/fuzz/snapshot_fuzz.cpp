// Snapshot files, by way of HDF5, whose own code is not instrumented.
#include "analysis/snapshot.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = talus::testing::fuzz_file("snapshots.h5", data, size);
  talus::testing::may_refuse<talus::analysis::SnapshotError>([&] { talus::analysis::read_snapshots(file); });
  return 0;
}
